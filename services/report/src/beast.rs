//! Mode S Beast: binary frames with a stamp and a level.
//!
//! ```text
//!   1A  '1' | '2' | '3'     stamp, 6 bytes, high byte first   level            2 | 7 | 14 bytes of the frame
//!       Mode A/C short long                                   1-FE, FF unknown
//!   after the type, every 1A of stamp, level and frame is sent twice
//! ```
//! | stamp | content | names | none |
//! |---|---|---|---|
//! | 12 MHz | counts since the start of capture, 48 bits, never restarting | end of the first 56 bits; Mode A/C: F2 | – |
//! | GPS | second of the day << 30 | nanoseconds | end of the frame; Mode A/C: F2 | six zero bytes |
//!
//! In GPS mode a status message (`radarcape`) goes out once a second, by which readers know the mode. This module is all that a frame needs
//! and stands in SRAM.
//!
//! Source: the Beast's public data format description (wiki of Mode-S Beast) and the vector in this file's test; the GPS form as the
//! reader of mlat-client takes it.

use crate::Full;
use crate::frame_report::{Bits, DAY_S, FrameReport, FrameTimes, SECOND_NS};
use crate::level;

/// A slice that holds any Beast message: every one of 21 bytes doubled, and two.
pub const MAX_MESSAGE: usize = 2 + 2 * (6 + 1 + 14);

/// Ticks of the 120 MHz system clock in one count of the 12 MHz stamp.
pub const TICKS_PER_COUNT: u64 = 10;
/// From the arrival (leading edge of the preamble) to the end of the first 56 bits: 64 µs in ticks of 120 MHz.
pub const STAMP_AFTER_ARRIVAL_TICKS: u64 = (8 + 56) * 120;
/// From F1 to F2 of a Mode A/C reply: 20.3 µs in ticks of 120 MHz.
pub const F2_AFTER_F1_TICKS: u64 = 2_436;
/// The same in nanoseconds.
const F2_AFTER_F1_NS: u32 = 20_300;
/// The bit of a reply that tells the special position identification pulse: free in the format, and where readers of the dump1090 family look for it.
pub const SPI_BIT: u16 = 0x80;
/// Preamble and bits of a short frame, ns.
const SHORT_NS: u32 = 64_000;
/// Preamble and bits of a long frame, ns.
const LONG_NS: u32 = 120_000;
/// Level byte of a frame whose level is unknown.
pub const LEVEL_UNKNOWN: u8 = level::UNKNOWN;

const ESCAPE: u8 = 0x1A;

/// Which stamp frames carry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stamp {
    /// 12 MHz since the start of capture.
    #[default]
    Count12Mhz,
    /// Second of the day and nanoseconds, UTC.
    Gps,
}

/// One frame.
pub fn frame(report: &FrameReport<'_>, stamp: Stamp, out: &mut [u8]) -> Result<usize, Full> {
    let reply;
    let (kind, data): (u8, &[u8]) = match report.bits {
        Bits::ModeS(frame) if frame.is_long() => (b'3', frame.bytes()),
        Bits::ModeS(frame) => (b'2', frame.bytes()),
        Bits::ModeAc { code, spi } => {
            reply = (code.pulses() | if spi { SPI_BIT } else { 0 }).to_be_bytes();
            (b'1', &reply)
        }
    };
    let stamp = match stamp {
        Stamp::Count12Mhz => count(&report.times, kind),
        Stamp::Gps => gps(&report.times, kind),
    };
    message(kind, stamp, level::byte(report.level_cdbm), data, out)
}

/// 12 MHz counts to the instant that a message of this kind names.
fn count(times: &FrameTimes, kind: u8) -> u64 {
    let later = match kind {
        b'1' => F2_AFTER_F1_TICKS,
        _ => STAMP_AFTER_ARRIVAL_TICKS,
    };
    tenth(times.arrival.wrapping_add(later))
}

/// Whole tenths ([`TICKS_PER_COUNT`]), for every frame: without the division of 64 bits, for which the core has no instruction.
fn tenth(ticks: u64) -> u64 {
    /// 5 × this = 1 in 64 bits: what 5 divides exactly is divided by multiplying.
    const INVERSE_OF_5: u64 = 0xCCCC_CCCC_CCCC_CCCD;
    let half = ticks >> 1;
    // What is left of `half` by 5 is what is left of the sum of its 16-bit parts: 2^16 is 1 above a multiple of 5.
    let part = |shift: u32| (half >> shift) as u32 & 0xFFFF;
    let sum = part(0) + part(16) + part(32) + part(48);
    let sum = (sum & 0xFFFF) + (sum >> 16);
    // A fifth of up to 65 538: 52 429 is a fifth of 2^18, rounded up.
    let rest = sum - ((sum * 52_429) >> 18) * 5;
    (half - u64::from(rest)).wrapping_mul(INVERSE_OF_5)
}

/// Second of the day and nanoseconds of the instant that a message of this kind names; 0 while unknown.
fn gps(times: &FrameTimes, kind: u8) -> u64 {
    let (Some(second), Some(ns)) = (times.utc_second, times.since_pps_ns) else {
        return 0;
    };
    let later = match kind {
        b'1' => F2_AFTER_F1_NS,
        b'2' => SHORT_NS,
        _ => LONG_NS,
    };
    seconds_and_ns(second, ns.saturating_add(later))
}

/// The GPS form of a time; a full second of nanoseconds is carried, also across midnight.
pub(crate) fn seconds_and_ns(second: u32, ns: u32) -> u64 {
    let (second, ns) = if ns >= SECOND_NS {
        (second.saturating_add(1), ns - SECOND_NS)
    } else {
        (second, ns)
    };
    let second = if second >= DAY_S {
        second - DAY_S
    } else {
        second
    };
    u64::from(second) << 30 | u64::from(ns)
}

/// One message with the stamp's low 48 bits and the level byte as they go out.
pub fn message(
    kind: u8,
    stamp: u64,
    level: u8,
    data: &[u8],
    out: &mut [u8],
) -> Result<usize, Full> {
    let mut places = out.iter_mut();
    let mut length = 0;
    let mut put = |byte| {
        *places.next().ok_or(Full)? = byte;
        length += 1;
        Ok(())
    };
    put(ESCAPE)?;
    put(kind)?;
    for &byte in stamp.to_be_bytes()[2..].iter().chain(&[level]).chain(data) {
        put(byte)?;
        if byte == ESCAPE {
            put(byte)?;
        }
    }
    Ok(length)
}

#[cfg(test)]
#[path = "beast_tests.rs"]
mod tests;
