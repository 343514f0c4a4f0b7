//! Fair counts of a recording, in which nobody knows what was sent: a frame counts by itself only where its parity alone proves it.
//!
//! | frame | counts |
//! |---|---|
//! | DF11 with code 0, DF17, DF18, as received | always; its address is known from then on |
//! | the same, repaired | after its address is known |
//! | DF11 with an interrogator code | the same |
//! | address parity (DF0, 4, 5, 16, 20, 21) | the same |
//! | anything else | never |
//!
//! No decoder is given a list of addresses.

use super::Decoded;
use mode_s::{Address, Frame, Parity};
use std::collections::HashSet;

/// Frames that count.
pub fn count(frames: &[Decoded]) -> usize {
    let mut known = HashSet::new();
    frames
        .iter()
        .filter(|decoded| {
            let Ok(frame) = Frame::from_bytes(&decoded.bytes) else {
                return false;
            };
            let parity = Parity::of(&frame);
            let Some(Address::Icao(address)) = parity.address() else {
                return false;
            };
            match parity {
                Parity::Exact(_) if decoded.repaired == 0 => {
                    known.insert(address.0);
                    true
                }
                Parity::Exact(_) | Parity::Interrogator { .. } | Parity::Address(_) => {
                    known.contains(&address.0)
                }
                _ => false,
            }
        })
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use twin::source::scene::traffic::df17;

    fn decoded(bytes: &[u8], repaired: u8) -> Decoded {
        Decoded {
            bytes: bytes.to_vec(),
            repaired,
            arrival_ps: None,
        }
    }

    #[test]
    fn repaired_and_address_parity_frames_wait_for_an_exact_one() {
        let exact = df17(0xAD_9293, 11 << 51);
        let short = [0x02, 0xE1, 0x97, 0x1C, 0xE1, 0x7C, 0x84];
        let (exact, repaired) = (decoded(exact.bytes(), 0), decoded(exact.bytes(), 1));
        // DF0 of the same address.
        let short = decoded(&short, 0);
        assert_eq!(count(&[repaired.clone(), short.clone()]), 0);
        assert_eq!(count(&[exact, repaired, short]), 3);
    }
}
