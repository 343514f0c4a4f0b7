//! What the receiver repaired, found again from the bits as received.
//!
//! Raw protocols carry a frame's bits before repair. The parity code's distance is 6, so at most two wrong bits of a DF11, 17 or 18 are named by the
//! residual alone; one wrong bit of an address-parity frame is named by the addresses that exact frames have shown before.

use std::collections::HashSet;

use mode_s::{Address, Frame, Parity, crc24};

/// Bits of DF, which are never repaired.
const DF_BITS: usize = 5;

/// Completes frames in their order.
#[derive(Default)]
pub struct Completed {
    heard: HashSet<u32>,
}

impl Completed {
    /// The frame as the receiver believed it, and how many bits it repaired.
    pub fn complete(&mut self, received: &Frame) -> (Frame, u8) {
        match Parity::of(received) {
            Parity::Exact(address) => {
                if let Address::Icao(icao) = address {
                    self.heard.insert(icao.0);
                }
                (*received, 0)
            }
            Parity::Broken => explained(received, 2, |residual| residual == 0),
            Parity::Address(icao) if !self.heard.contains(&icao.0) => {
                explained(received, 1, |residual| self.heard.contains(&residual))
            }
            _ => (*received, 0),
        }
    }
}

/// The first set of at most `most` flips that leaves a residual that `fits`; the frame as it is when there is none.
fn explained(received: &Frame, most: u8, fits: impl Fn(u32) -> bool) -> (Frame, u8) {
    let bytes = received.bytes();
    let residual = crc24::residual(bytes);
    let bits = DF_BITS..bytes.len() * 8;
    let flipped = |bit: usize| {
        let mut alone = vec![0; bytes.len()];
        alone[bit / 8] = 0x80 >> (bit % 8);
        crc24::residual(&alone)
    };
    let syndromes: Vec<(usize, u32)> = bits.map(|bit| (bit, flipped(bit))).collect();
    let repaired = |flips: &[usize]| {
        let mut bytes = bytes.to_vec();
        flips
            .iter()
            .for_each(|bit| bytes[bit / 8] ^= 0x80 >> (bit % 8));
        (
            Frame::from_bytes(&bytes).unwrap_or(*received),
            flips.len() as u8,
        )
    };
    if let Some(&(bit, _)) = syndromes.iter().find(|(_, s)| fits(residual ^ s)) {
        return repaired(&[bit]);
    }
    for (at, &(first, a)) in
        syndromes
            .iter()
            .enumerate()
            .take(if most > 1 { usize::MAX } else { 0 })
    {
        let others = &syndromes[at + 1..];
        if let Some(&(second, _)) = others.iter().find(|(_, b)| fits(residual ^ a ^ b)) {
            return repaired(&[first, second]);
        }
    }
    (*received, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(hex: &str) -> Frame {
        let byte =
            |at: usize| u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).expect("hexadecimal");
        let bytes: Vec<u8> = (0..hex.len() / 2).map(byte).collect();
        Frame::from_bytes(&bytes).expect("a frame")
    }

    #[test]
    fn two_wrong_bits_are_found_and_three_are_left() {
        let mut completed = Completed::default();
        let right = frame("8d4ca7e858b9838206ba422bbd7b");
        for (wrong, expected) in [
            (&[40][..], Some(1)),
            (&[6, 111], Some(2)),
            (&[7, 50, 90], None),
        ] {
            let mut bytes = right.bytes().to_vec();
            wrong
                .iter()
                .for_each(|bit: &usize| bytes[bit / 8] ^= 0x80 >> (bit % 8));
            let received = Frame::from_bytes(&bytes).expect("a frame");
            let (frame, repaired) = completed.complete(&received);
            match expected {
                Some(count) => assert_eq!((frame, repaired), (right, count)),
                None => assert_eq!((frame, repaired), (received, 0)),
            }
        }
    }

    #[test]
    fn address_parity_is_completed_once_the_address_was_heard() {
        let mut completed = Completed::default();
        let received = frame("02e1971ce17c84");
        let address = crc24::residual(received.bytes());
        let mut bytes = received.bytes().to_vec();
        bytes[3] ^= 4;
        let wrong = Frame::from_bytes(&bytes).expect("a frame");
        assert_eq!(completed.complete(&wrong), (wrong, 0));
        let mut call = [0x5d, 0, 0, 0].to_vec();
        call[1..].copy_from_slice(&address.to_be_bytes()[1..]);
        let parity = crc24::remainder(&call);
        call.extend(&parity.to_be_bytes()[1..]);
        completed.complete(&Frame::from_bytes(&call).expect("a frame"));
        assert_eq!(completed.complete(&wrong), (received, 1));
    }
}
