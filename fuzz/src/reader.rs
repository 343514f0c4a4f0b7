//! Any bytes as steps.
//!
//! ```text
//!   byte 0 of a step   0-239 a frame follows (14 or 7 bytes by its own DF, fewer at the end)   240-247 Mode A/C   248-253 a second ends
//!                      254, 255 the receiver's place (eight bytes)
//!   bytes 1, 2         milliseconds since the step before; FFFF: eight bytes of any time follow
//! ```

use crate::Step;
use mode_s::{Df, Position};
use tracker::RxPosition;

/// The steps with their times.
pub fn steps(mut bytes: &[u8]) -> impl Iterator<Item = (u64, Step)> {
    let mut now_ms = 0u64;
    std::iter::from_fn(move || {
        let kind = take::<1>(&mut bytes)?[0];
        let later = u16::from_be_bytes(take::<2>(&mut bytes)?);
        now_ms = match later {
            0xFFFF => u64::from_be_bytes(take::<8>(&mut bytes)?),
            later => now_ms.saturating_add(later.into()),
        };
        let step = match kind {
            0..=239 => {
                let is_long = bytes
                    .first()
                    .is_some_and(|&first| Df::of_first_byte(first).is_long());
                let length = bytes.len().min(if is_long { 14 } else { 7 });
                let (frame, rest) = bytes.split_at(length);
                bytes = rest;
                Step::Bytes(frame.to_vec())
            }
            240..=247 => Step::ModeAc(u16::from_be_bytes(take::<2>(&mut bytes)?)),
            248..=253 => Step::Second,
            _ => Step::Rx(RxPosition::Fixed(Position {
                latitude: i32::from_be_bytes(take::<4>(&mut bytes)?)
                    .clamp(-900_000_000, 900_000_000),
                longitude: i32::from_be_bytes(take::<4>(&mut bytes)?)
                    .clamp(-1_800_000_000, 1_799_999_999),
            })),
        };
        Some((now_ms, step))
    })
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (taken, rest) = bytes.split_first_chunk::<N>()?;
    *bytes = rest;
    Some(*taken)
}
