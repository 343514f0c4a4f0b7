//! Can these be the fields of a reply? Asked of address-parity frames, whose parity proves little, and of repaired squitters.
//!
//! | DF | bits | field | what a transponder sends |
//! |---|---|---|---|
//! | 0, 16 | 6 7 8 | VS, CC (DF16: spare), spare | bit 8 is 0; in DF16 bits 7 and 8 are |
//! | 0, 16 | 12-13, 18-19 | spare | 0 |
//! | 4, 5, 20, 21 | 6-8 | FS | 0 to 5; 6 and 7 are not assigned |
//! | 4, 5, 20, 21 | 9-13 | DR | 0 to 7 and 16 to 31; 8 to 15 are not assigned |
//! | 24 to 31 | 3 | spare | 0 |
//!
//! A fit by chance passes one time in 32 (DF0), one in 64 (DF16), one in two (the others). Most of what passes says what hardly anybody sends (`unusual`): that must be
//! surer.
//!
//! Source: ICAO Annex 10 Volume IV, 3.1.2.6 and 3.1.2.8 (the formats' fields), as `mode-s` reads them.

/// Whether every limited field of the frame has a value that is assigned.
#[inline(never)]
pub(crate) fn fields(frame: &[u8]) -> bool {
    let [first, second, third, ..] = *frame else {
        return false;
    };
    match first >> 3 {
        0 => first & 0x01 == 0 && second & 0x18 == 0 && third & 0x60 == 0,
        16 => first & 0x03 == 0 && second & 0x18 == 0 && third & 0x60 == 0,
        4 | 5 | 20 | 21 => first & 0x07 <= 5 && !matches!(second >> 3, 8..=15),
        24.. => first & 0x20 == 0,
        _ => true,
    }
}

/// Whether a frame says what transponders may send but hardly ever do:
///
/// | DF | field | usual | in the two-hour log of the golden tests |
/// |---|---|---|---|
/// | 4, 5, 20, 21 | FS | 0, 1: no alert, no SPI | all but 35 of 59 460 |
/// | 4, 5, 20, 21 | DR | 0, 4, 5: nothing or a Comm-B broadcast to fetch | all but 5 |
/// | 24 to 31 | | none: Comm-D | none |
///
/// Of the replies that chance makes and [`fields`] passes 49 of 50 are so.
#[inline(never)]
pub(crate) fn unusual(frame: &[u8]) -> bool {
    let [first, second, ..] = *frame else {
        return false;
    };
    match first >> 3 {
        4 | 5 | 20 | 21 => first & 0x07 > 1 || !matches!(second >> 3, 0 | 4 | 5),
        downlink_format => downlink_format >= 24,
    }
}

/// Whether a repaired squitter (DF17, 18) of an aircraft not heard lately may be believed: its fields have values that transponders send.
///
/// | DF | bits | field | what is sent |
/// |---|---|---|---|
/// | 17 | 6-8 | CA | 4 to 7: a transponder that squitters positions is of level 2 or more |
/// | 18 | 6-8 | CF | 0 to 6; 7 is reserved |
/// | 17, 18 | 9-32 | AA | neither all zeros nor all ones |
/// | 17, 18 | 33-37 | TC | 0 to 22, 28, 29 and 31; the others are reserved or for tests |
///
/// A fit by chance passes two times in five (DF17). DF11 has too few bits to be believed so. Source: ICAO Annex 10 Volume IV, 3.1.2.8.6; DO-260B, table 2-11.
#[inline(never)]
pub(crate) fn squitter(frame: &[u8]) -> bool {
    let [first, a, b, c, fifth, ..] = *frame else {
        return false;
    };
    let capability = first & 0x07;
    let known = match first >> 3 {
        17 => capability >= 4,
        18 => capability != 7,
        _ => return false,
    };
    known
        && ![[0; 3], [0xFF; 3]].contains(&[a, b, c])
        && matches!(fifth >> 3, 0..=22 | 28 | 29 | 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recorded_replies_pass() {
        // DF0, DF4, DF5, DF20 from recordings.
        for frame in [
            [0x02, 0xE1, 0x97, 0x1C, 0xE1, 0x7C, 0x84],
            [0x20, 0x00, 0x06, 0xA2, 0x00, 0x00, 0x00],
            [0x28, 0x00, 0x1B, 0x2B, 0x0B, 0x4A, 0x1A],
            [0xA0, 0x00, 0x17, 0x18, 0x10, 0x01, 0x0A],
        ] {
            assert!(fields(&frame), "{frame:02x?}");
        }
    }

    #[test]
    fn fields_that_are_not_assigned_are_refused() {
        for frame in [
            [0x01, 0xE1, 0x97],
            [0x02, 0xE9, 0x97],
            [0x02, 0xE1, 0xB7],
            [0x82, 0xE1, 0x97],
            [0x26, 0x00, 0x06],
            [0x28, 0x40, 0x06],
            [0xAF, 0x00, 0x06],
            [0xE3, 0x00, 0x06],
        ] {
            assert!(!fields(&frame), "{frame:02x?}");
        }
        assert!(!fields(&[0x20]));
    }

    #[test]
    fn what_hardly_anybody_sends_is_unusual() {
        for frame in [
            [0xC3, 0x12],
            [0x20, 0x80],
            [0x28, 0xFF],
            [0xA0, 0x08],
            [0x22, 0x00],
            [0xAD, 0x00],
        ] {
            assert!(unusual(&frame), "{frame:02x?}");
        }
        for frame in [
            [0x20, 0x28],
            [0xA9, 0x00],
            [0x02, 0xE1],
            [0x80, 0xE1],
            [0xA0, 0x27],
        ] {
            assert!(!unusual(&frame), "{frame:02x?}");
        }
    }

    #[test]
    fn squitters_are_believed_by_their_fields() {
        assert!(squitter(&[0x8D, 0x4C, 0xA7, 0xE8, 0x58]));
        assert!(squitter(&[0x90, 0x4C, 0xA7, 0xE8, 0xF8]));
        for frame in [
            [0x8B, 0x4C, 0xA7, 0xE8, 0x58],
            [0x97, 0x4C, 0xA7, 0xE8, 0x58],
            [0x8D, 0x00, 0x00, 0x00, 0x58],
            [0x8D, 0xFF, 0xFF, 0xFF, 0x58],
            [0x8D, 0x4C, 0xA7, 0xE8, 0xC0],
            [0x5D, 0x4C, 0xA7, 0xE8, 0x58],
        ] {
            assert!(!squitter(&frame), "{frame:02x?}");
        }
        assert!(!squitter(&[0x8D]));
    }
}
