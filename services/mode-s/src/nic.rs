//! NIC, the navigation integrity category: how far the true position may lie from the one told, 0-11.
//!
//! ```text
//!   NIC              11     10    9     8       7       6       5     4     3     2     1      0
//!   within        7.5 m   25 m  75 m  0.1 NM  0.2 NM  0.6 NM  1 NM  2 NM  4 NM  8 NM  20 NM  unknown
//! ```
//! The type code of a position tells it nearly; supplement bits, whose number grew with the version, tell it exactly. A supplement
//! not heard yet counts as 0, which never gives a NIC better than the true one. Version 0 knows no NIC: its NUCp is read as the NIC
//! whose radius holds it. Source: "The 1090 Megahertz Riddle", uncertainty, its tables for versions 0, 1 and 2.

/// The supplement bits; `false` where the version has none or it is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NicSupplements {
    /// NIC-A, of the operational status (the only one of version 1).
    pub a: bool,
    /// NIC-B, of the airborne position.
    pub b: bool,
    /// NIC-C, of the operational status on the surface.
    pub c: bool,
}

/// NIC of a position's type code (5-18, 20-22) sent by an aircraft of this version; 0 for any other.
pub const fn nic(type_code: u8, version: u8, supplements: NicSupplements) -> u8 {
    let NicSupplements { a, b, c } = supplements;
    match (type_code, version) {
        (5 | 9 | 20, _) => 11,
        (6 | 10 | 21, _) => 10,
        (7, 1..) if a && (version == 1 || !c) => 9,
        (11, 1..) if a && (version == 1 || b) => 9,
        (7 | 11, _) => 8,
        (8, 2..) => match (a, c) {
            (true, true) => 7,
            (true, false) | (false, true) => 6,
            (false, false) => 0,
        },
        (12, _) => 7,
        (13, _) => 6,
        (14, _) => 5,
        (15, _) => 4,
        // NUCp 2 of version 0 is 10 NM.
        (16, 0) => 1,
        (16, 1..) if a && (version == 1 || b) => 3,
        (16, _) => 2,
        (17, _) => 1,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: NicSupplements = NicSupplements {
        a: false,
        b: false,
        c: false,
    };
    const A: NicSupplements = NicSupplements { a: true, ..NONE };
    const B: NicSupplements = NicSupplements { b: true, ..NONE };
    const C: NicSupplements = NicSupplements { c: true, ..NONE };
    const AB: NicSupplements = NicSupplements { b: true, ..A };
    const AC: NicSupplements = NicSupplements { c: true, ..A };

    #[test]
    fn nic_by_type_code_without_supplements() {
        for (version, nic_of_16) in [(0, 1), (1, 2), (2, 2)] {
            let nics = [11, 10, 8, 7, 6, 5, 4, nic_of_16, 1, 0];
            for (type_code, expected) in (9..=18).zip(nics) {
                let told = nic(type_code, version, NONE);
                assert_eq!(told, expected, "TC {type_code} version {version}");
            }
            for (type_code, expected) in [(20, 11), (21, 10), (22, 0), (5, 11), (6, 10), (7, 8)] {
                assert_eq!(nic(type_code, version, NONE), expected, "TC {type_code}");
            }
            assert_eq!(nic(8, version, NONE), 0);
        }
    }

    #[test]
    fn supplements_by_version() {
        for (type_code, version, supplements, expected) in [
            (11, 0, AB, 8),
            (11, 1, A, 9),
            (11, 2, A, 8),
            (11, 2, B, 8),
            (11, 2, AB, 9),
            (16, 0, AB, 1),
            (16, 1, A, 3),
            (16, 2, A, 2),
            (16, 2, AB, 3),
            (7, 0, A, 8),
            (7, 1, A, 9),
            (7, 2, A, 9),
            (7, 2, AC, 8),
            (8, 1, A, 0),
            (8, 2, AC, 7),
            (8, 2, A, 6),
            (8, 2, C, 6),
        ] {
            let told = nic(type_code, version, supplements);
            assert_eq!(
                told, expected,
                "TC {type_code} version {version} {supplements:?}"
            );
        }
    }

    #[test]
    fn a_supplement_never_lowers_nic_in_the_air() {
        for type_code in 9..=22 {
            for version in 0..=7 {
                for supplements in [A, B, C, AB, AC] {
                    assert!(nic(type_code, version, supplements) >= nic(type_code, version, NONE));
                }
            }
        }
    }
}
