//! What the categories of quality stand for, in metres and metres a second: for people, not for the receiver.
//!
//! | NACp | 11 | 10 | 9 | 8 | 7 | 6 | 5 | 4 | 3 | 2 | 1 |
//! |---|---|---|---|---|---|---|---|---|---|---|---|
//! | EPU, m | 3 | 10 | 30 | 93 | 185 | 556 | 926 | 1852 | 3704 | 7408 | 18 520 |
//! | VEPU, m | 4 | 15 | 45 | | | | | | | | |
//!
//! | NACv | 4 | 3 | 2 | 1 |
//! |---|---|---|---|---|
//! | horizontal error below, m/s | 0.3 | 1 | 3 | 10 |
//! | vertical error below, m/s | 0.46 | 1.5 | 4.5 | 15.2 |
//!
//! | SIL | 3 | 2 | 1 |
//! |---|---|---|---|
//! | probability of leaving the radius unnoticed | 1e-7 | 1e-5 | 1e-3 |
//!
//! | GVA | 2 | 1 |
//! |---|---|---|
//! | vertical error below, m | 45 | 150 |
//!
//! EPU is the radius that holds the position with 95 %; the containment radius Rc (`radius_dm`) with the probability of SIL. Source: "The
//! 1090 Megahertz Riddle", uncertainty, its tables for versions 0, 1 and 2; GVA from DO-260B.

use crate::nic::{NicSupplements, nic};

/// EPU of a NACp, metres.
pub const fn epu_m(nac_p: u8) -> Option<u16> {
    Some(match nac_p {
        11 => 3,
        10 => 10,
        9 => 30,
        8 => 93,
        7 => 185,
        6 => 556,
        5 => 926,
        4 => 1_852,
        3 => 3_704,
        2 => 7_408,
        1 => 18_520,
        _ => return None,
    })
}

/// VEPU of a NACp, metres.
pub const fn vepu_m(nac_p: u8) -> Option<u8> {
    match nac_p {
        11 => Some(4),
        10 => Some(15),
        9 => Some(45),
        _ => None,
    }
}

/// Horizontal and vertical velocity error of a NACv (NUCr of version 0), centimetres a second.
pub const fn velocity_error_cm_s(nac_v: u8) -> Option<(u16, u16)> {
    match nac_v {
        4 => Some((30, 46)),
        3 => Some((100, 150)),
        2 => Some((300, 450)),
        1 => Some((1_000, 1_520)),
        _ => None,
    }
}

/// Negative decimal exponent of a SIL's probability.
pub const fn integrity_exponent(sil: u8) -> Option<u8> {
    match sil {
        3 => Some(7),
        2 => Some(5),
        1 => Some(3),
        _ => None,
    }
}

/// Vertical error of a GVA, metres.
pub const fn gva_m(gva: u8) -> Option<u8> {
    match gva {
        2 => Some(45),
        1 => Some(150),
        _ => None,
    }
}

/// Containment radius of a position by its type code, version and supplements, decimetres.
pub const fn radius_dm(type_code: u8, version: u8, supplements: NicSupplements) -> Option<u32> {
    const NAUTICAL_MILE_DM: u32 = 18_520;
    let NicSupplements { a, b, c } = supplements;
    Some(match (nic(type_code, version, supplements), version) {
        (11, _) => 75,
        (10, _) => 250,
        (9, _) => 750,
        (8, _) => NAUTICAL_MILE_DM / 10,
        (7, _) => NAUTICAL_MILE_DM / 5,
        // NIC 6 has three radii, by the supplements; without any 0.5 NM in the air.
        (6, 1) if type_code == 13 && a => NAUTICAL_MILE_DM * 6 / 10,
        (6, 2..) if type_code == 13 && a && b => NAUTICAL_MILE_DM * 6 / 10,
        (6, 2..) if type_code == 13 && b => NAUTICAL_MILE_DM * 3 / 10,
        (6, 2..) if type_code == 8 && a => NAUTICAL_MILE_DM * 3 / 10,
        (6, 2..) if type_code == 8 && c => NAUTICAL_MILE_DM * 6 / 10,
        (6, _) => NAUTICAL_MILE_DM / 2,
        (5, _) => NAUTICAL_MILE_DM,
        (4, _) => NAUTICAL_MILE_DM * 2,
        (3, _) => NAUTICAL_MILE_DM * 4,
        (2, _) => NAUTICAL_MILE_DM * 8,
        // NUCp 2 of version 0 is 10 NM.
        (1, 0) if type_code == 16 => NAUTICAL_MILE_DM * 10,
        (1, _) => NAUTICAL_MILE_DM * 20,
        _ => return None,
    })
}

/// NUCp of a position's type code, as version 0 means it.
pub const fn nucp(type_code: u8) -> u8 {
    match type_code {
        5..=8 => 14 - type_code,
        9..=18 => 18 - type_code,
        20 | 21 => 29 - type_code,
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

    #[test]
    fn better_categories_have_smaller_figures() {
        let epus: std::vec::Vec<u16> = (1..=11).filter_map(epu_m).collect();
        assert_eq!(epus.len(), 11);
        assert!(epus.is_sorted_by(|worse, better| worse > better));
        assert_eq!((epu_m(0), epu_m(12)), (None, None));
        assert_eq!((vepu_m(8), vepu_m(9)), (None, Some(45)));
        assert_eq!(velocity_error_cm_s(4), Some((30, 46)));
        assert_eq!(
            (velocity_error_cm_s(0), velocity_error_cm_s(5)),
            (None, None)
        );
        assert_eq!(
            [0, 1, 2, 3].map(integrity_exponent),
            [None, Some(3), Some(5), Some(7)]
        );
        assert_eq!([0, 1, 2, 3].map(gva_m), [None, Some(150), Some(45), None]);
    }

    #[test]
    fn radii_by_version() {
        let with = |a, b, c| NicSupplements { a, b, c };
        for (type_code, version, supplements, radius) in [
            (9, 2, NONE, Some(75)),
            (11, 2, with(true, true, false), Some(750)),
            (11, 2, NONE, Some(1_852)),
            (13, 0, NONE, Some(9_260)),
            (13, 1, with(true, false, false), Some(11_112)),
            (13, 2, with(false, true, false), Some(5_556)),
            (13, 2, with(true, true, false), Some(11_112)),
            (8, 2, with(true, false, false), Some(5_556)),
            (8, 2, with(false, false, true), Some(11_112)),
            (8, 2, with(true, false, true), Some(3_704)),
            (8, 1, NONE, None),
            (16, 0, NONE, Some(185_200)),
            (16, 2, NONE, Some(148_160)),
            (17, 2, NONE, Some(370_400)),
            (18, 2, NONE, None),
        ] {
            let told = radius_dm(type_code, version, supplements);
            assert_eq!(
                told, radius,
                "TC {type_code} version {version} {supplements:?}"
            );
        }
    }

    #[test]
    fn nucp_of_every_type_code() {
        let nucps: std::vec::Vec<u8> = (5..=22).map(nucp).collect();
        assert_eq!(
            nucps,
            [9, 8, 7, 6, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 0, 9, 8, 0]
        );
    }
}
