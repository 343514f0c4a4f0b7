//! Comm-D (DF24): one segment of an extended-length message (ELM), or the answer to segments sent up.
//!
//! ```text
//!   1 2 3 4  5  8 9                                        88 89     112
//!   |1 1|.|KE| ND | MD, ten bytes                            | AP      |
//! ```
//! DF24 has two bits only, so 11000 to 11111 are all DF24. KE = 0: MD is segment ND of a downlink ELM. KE = 1: MD begins with TAS, 16
//! bits that name the uplink segments received. The content is the application's (the aeronautical telecommunication network), so
//! it is handed on and not read. Source: ICAO Annex 10 Volume IV (the KE, ND, MD and TAS fields).

use crate::frame::Frame;

/// DF24.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommD {
    /// KE: an answer to uplink segments; otherwise a downlink segment.
    pub is_acknowledgement: bool,
    /// ND: number of the segment, 0-15.
    pub segment: u8,
    /// MD.
    pub content: [u8; 10],
}

impl CommD {
    pub(crate) fn decode(frame: &Frame) -> CommD {
        let mut content = [0; 10];
        content.copy_from_slice(&frame.long_bytes()[1..11]);
        CommD {
            is_acknowledgement: frame.bits(4, 4) == 1,
            segment: frame.bits(5, 8) as u8,
            content,
        }
    }

    /// TAS of an acknowledgement: uplink segments received, segment 0 as the highest bit.
    pub const fn received_segments(&self) -> Option<u16> {
        if self.is_acknowledgement {
            Some(u16::from_be_bytes([self.content[0], self.content[1]]))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comm_d(first: u8) -> CommD {
        let mut bytes = [0; 14];
        bytes[0] = first;
        for (content, number) in bytes[1..11].iter_mut().zip(0xA1..) {
            *content = number;
        }
        CommD::decode(&Frame::from_bytes(&bytes).unwrap())
    }

    #[test]
    fn a_downlink_segment() {
        let segment = comm_d(0b1100_0101);
        assert_eq!(segment.segment, 5);
        assert_eq!(segment.content[0], 0xA1);
        assert_eq!(segment.content[9], 0xAA);
        assert_eq!(segment.received_segments(), None);
    }

    #[test]
    fn an_acknowledgement_names_segments_and_the_spare_bit_counts_nothing() {
        for first in [0b1101_0000, 0b1111_0000] {
            let answer = comm_d(first);
            assert_eq!(answer.segment, 0);
            assert_eq!(answer.received_segments(), Some(0xA1A2));
        }
    }
}
