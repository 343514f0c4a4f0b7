//! Emitter category: one internal form (TC, CA), one table out for each protocol family, and FLARM's types in.
//!
//! | set (TC) | CA 0 | 1 | 2 | 3 | 4 | 5 | 6 | 7 |
//! |---|---|---|---|---|---|---|---|---|
//! | A (4) | none | light | medium 1 | medium 2 | high vortex | heavy | high performance | rotorcraft |
//! | B (3) | none | glider | lighter than air | parachutist | ultralight | reserved | unmanned | space |
//! | C (2) | none | emergency vehicle | service vehicle | point obstacle | cluster obstacle | line obstacle | reserved | reserved |
//! | D (1) | none | reserved … | | | | | | |
//!
//! | family | unknown | reserved by DO-260B | a category that no set has |
//! |---|---|---|---|
//! | CSBee | 2 | 1 | 0 |
//! | AERO, JSON, MAVLink, GDL90 | 0 | 0 (B5: 13) | 0 |
//! | ASTERIX I021/020 | 0 | 0 | 0 |
//!
//! Source: "The 1090 Megahertz Riddle" (the sets); the ADSBee 1090 document 4.1.1.2 (its numbers; lighter-than-air, which it forgets, is 2);
//! the OEM TT-SG1a document, table 16; EUROCONTROL CAT021 edition 2.1, item 020; the OEM TT-SF1 document, tables 20 and 21.

use mode_s::Category;

/// Numbers by set A, B, C, D and CA.
type Table = [[u8; 8]; 4];

static CSBEE: Table = [
    [2, 11, 12, 13, 14, 15, 16, 17],
    [2, 6, 2, 7, 8, 1, 9, 10],
    [2, 3, 4, 5, 5, 5, 1, 1],
    [2, 1, 1, 1, 1, 1, 1, 1],
];

static AERO: Table = [
    [0, 1, 2, 3, 4, 5, 6, 7],
    [0, 9, 10, 11, 12, 13, 14, 15],
    [0, 17, 18, 19, 20, 21, 0, 0],
    [0; 8],
];

static ASTERIX: Table = [
    [0, 1, 2, 3, 4, 5, 6, 10],
    [0, 11, 12, 16, 15, 0, 13, 14],
    [0, 20, 21, 22, 23, 24, 0, 0],
    [0; 8],
];

/// MAVLink's last emitter type, a point obstacle: clusters and lines are told as one, because a strict reader refuses numbers beyond.
const MAVLINK_LAST: u8 = 19;

/// FLARM's aircraft types 0-15 as (TC, CA). Where the document's two tables differ (jet: large or small), the MAVLink one.
static FLARM: [(u8, u8); 16] = [
    (4, 0),
    (3, 1),
    (4, 1),
    (4, 7),
    (3, 3),
    (4, 1),
    (3, 4),
    (3, 4),
    (4, 1),
    (4, 3),
    (4, 0),
    (3, 2),
    (3, 2),
    (3, 6),
    (4, 0),
    (2, 4),
];

fn number(table: &Table, category: Category) -> u8 {
    let set = 4usize.checked_sub(usize::from(category.type_code));
    set.and_then(|set| table.get(set)?.get(usize::from(category.ca)))
        .copied()
        .unwrap_or(0)
}

/// ECAT in CSBee.
pub(crate) fn csbee(category: Category) -> u8 {
    number(&CSBEE, category)
}

/// ECAT in AERO, JSON and GDL90.
pub(crate) fn aero(category: Category) -> u8 {
    number(&AERO, category)
}

/// Emitter type in MAVLink.
pub(crate) fn mavlink(category: Category) -> u8 {
    aero(category).min(MAVLINK_LAST)
}

/// ECAT in ASTERIX.
pub(crate) fn asterix(category: Category) -> u8 {
    number(&ASTERIX, category)
}

/// The category of a FLARM aircraft type; a type that FLARM does not have says nothing.
pub fn of_flarm(aircraft_type: u8) -> Category {
    let (type_code, ca) = FLARM
        .get(usize::from(aircraft_type))
        .copied()
        .unwrap_or((4, 0));
    Category { type_code, ca }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_documents() {
        for (type_code, ca, in_csbee, in_aero, in_asterix) in [
            (4, 0, 2, 0, 0),
            (4, 1, 11, 1, 1),
            (4, 2, 12, 2, 2),
            (4, 3, 13, 3, 3),
            (4, 4, 14, 4, 4),
            (4, 5, 15, 5, 5),
            (4, 6, 16, 6, 6),
            (4, 7, 17, 7, 10),
            (3, 1, 6, 9, 11),
            (3, 2, 2, 10, 12),
            (3, 3, 7, 11, 16),
            (3, 4, 8, 12, 15),
            (3, 6, 9, 14, 13),
            (3, 7, 10, 15, 14),
            (2, 1, 3, 17, 20),
            (2, 2, 4, 18, 21),
            (2, 3, 5, 19, 22),
            (2, 4, 5, 20, 23),
            (2, 5, 5, 21, 24),
            (1, 3, 1, 0, 0),
            (5, 0, 0, 0, 0),
            (4, 8, 0, 0, 0),
        ] {
            let category = Category { type_code, ca };
            assert_eq!(csbee(category), in_csbee, "{category:?}");
            assert_eq!(aero(category), in_aero, "{category:?}");
            assert_eq!(asterix(category), in_asterix, "{category:?}");
            assert_eq!(mavlink(category), in_aero.min(19), "{category:?}");
        }
    }

    #[test]
    fn flarm_types_as_the_documents_translate_them() {
        // Type, MAVLink's number, ASTERIX's where both tables agree.
        for (flarm, in_mavlink, in_asterix) in [
            (0, 0, 0),
            (1, 9, 11),
            (2, 1, 1),
            (3, 7, 10),
            (4, 11, 16),
            (6, 12, 15),
            (7, 12, 15),
            (8, 1, 1),
            (11, 10, 12),
            (12, 10, 12),
            (13, 14, 13),
            (15, 19, 23),
            (16, 0, 0),
        ] {
            assert_eq!(mavlink(of_flarm(flarm)), in_mavlink, "{flarm}");
            assert_eq!(asterix(of_flarm(flarm)), in_asterix, "{flarm}");
        }
        assert_eq!(mavlink(of_flarm(9)), 3);
    }
}
