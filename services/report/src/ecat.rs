//! Emitter category: one internal form (TC, CA), one table out for each protocol family.
//!
//! | set (TC) | CA 0 | 1 | 2 | 3 | 4 | 5 | 6 | 7 |
//! |---|---|---|---|---|---|---|---|---|
//! | A (4) | none | light | medium 1 | medium 2 | high vortex | heavy | high performance | rotorcraft |
//! | B (3) | none | glider | lighter than air | parachutist | ultralight | reserved | unmanned | space |
//! | C (2) | none | emergency vehicle | service vehicle | point obstacle | cluster obstacle | line obstacle | reserved | reserved |
//! | D (1) | none | reserved … | | | | | | |
//!
//! Source: "The 1090 Megahertz Riddle" (the sets), the ADSBee 1090 document 4.1.1.2 (its numbers; lighter-than-air, which it forgets, is 2).

use mode_s::Category;

/// CSBee's numbers by set A, B, C, D and CA.
static CSBEE: [[u8; 8]; 4] = [
    [2, 11, 12, 13, 14, 15, 16, 17],
    [2, 6, 2, 7, 8, 1, 9, 10],
    [2, 3, 4, 5, 5, 5, 1, 1],
    [2, 1, 1, 1, 1, 1, 1, 1],
];

/// ECAT 0: a category that no set has.
const INVALID: u8 = 0;

/// ECAT in CSBee.
pub(crate) fn csbee_ecat(category: Category) -> u8 {
    let set = 4usize.checked_sub(usize::from(category.type_code));
    set.and_then(|set| CSBEE.get(set)?.get(usize::from(category.ca)))
        .copied()
        .unwrap_or(INVALID)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_the_document() {
        for (type_code, ca, ecat) in [
            (4, 0, 2),
            (4, 1, 11),
            (4, 4, 14),
            (4, 7, 17),
            (3, 1, 6),
            (3, 2, 2),
            (3, 6, 9),
            (3, 7, 10),
            (2, 1, 3),
            (2, 2, 4),
            (2, 3, 5),
            (1, 3, 1),
            (5, 0, 0),
            (4, 8, 0),
        ] {
            let category = Category { type_code, ca };
            assert_eq!(csbee_ecat(category), ecat, "{category:?}");
        }
    }
}
