//! What a flash operation leaves when its power goes: units before it done, units after it untouched, one torn.
//!
//! ```text
//!   erase, a sector:   all cells to 0 first (pre-programming, 30 % of the time), then all to 1        0 ─▶ ▓ ─▶ 1
//!   program, a page:   cells that become 0, in any order
//! ```
//! Assumed: NOR flash data sheets (W25Q16JV among them) only say that data of an interrupted operation is not valid. Pre-programming
//! before the erase pulse is how NOR flash is built; that cells change one by one, in an order given by the seed, in proportion to the
//! time, is ours. Not modelled: cells left so weak that they read differently from time to time.

use crate::chip::flash::{PAGE, SECTOR};
use crate::chip::flash_journal::{Kind, Operation};
use crate::source::random::Random;

/// Share of a sector's erase in which its cells are all programmed first.
const PRE_PROGRAM: f64 = 0.3;

/// The bytes that `operation` leaves in place of `after` when only `share` of its time passes.
pub fn torn(operation: &Operation, after: &[u8], share: f64, seed: u64) -> Vec<u8> {
    let unit = match operation.kind {
        Kind::Erase => SECTOR,
        Kind::Program => PAGE,
    };
    let units = (after.len() / unit).max(1);
    let passed = share.clamp(0.0, 1.0) * units as f64;
    let mut random = Random::new(seed ^ operation.number << 32);
    let mut out = Vec::with_capacity(after.len());
    let pairs = operation.before.chunks(unit).zip(after.chunks(unit));
    for (number, (before, after)) in pairs.enumerate() {
        let done = passed - number as f64;
        if done >= 1.0 {
            out.extend_from_slice(after);
        } else if done <= 0.0 {
            out.extend_from_slice(before);
        } else {
            let bytes = before.iter().zip(after);
            out.extend(bytes.map(|(b, a)| match operation.kind {
                Kind::Program => b & !(chance(&mut random, done) & !a),
                Kind::Erase if done < PRE_PROGRAM => b & !chance(&mut random, done / PRE_PROGRAM),
                Kind::Erase => chance(&mut random, (done - PRE_PROGRAM) / (1.0 - PRE_PROGRAM)),
            }));
        }
    }
    out
}

/// Eight bits, each set with this probability.
fn chance(random: &mut Random, probability: f64) -> u8 {
    let mark = (probability * 256.0) as u8;
    let word = random.word().to_le_bytes();
    let bits = word.iter().enumerate();
    bits.fold(0, |byte, (n, draw)| byte | u8::from(*draw < mark) << n)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn operation(kind: Kind, before: Vec<u8>) -> Operation {
        Operation {
            number: 1,
            kind,
            offset: 0,
            before,
            start: 0,
            end: 100,
        }
    }

    fn ones(bytes: &[u8]) -> u32 {
        bytes.iter().map(|b| b.count_ones()).sum()
    }

    #[test]
    fn a_torn_program_lies_between_before_and_after_bit_by_bit() {
        let before = vec![0xf7; 256];
        let after = vec![0x05; 256];
        let program = operation(Kind::Program, before.clone());
        let mut last = ones(&before);
        for tenths in [1, 3, 5, 9] {
            let torn = torn(&program, &after, f64::from(tenths) / 10.0, 3);
            for (t, (b, a)) in torn.iter().zip(before.iter().zip(&after)) {
                assert_eq!(t & a, a & b, "a cell that stays 1");
                assert_eq!(t & !b, 0, "a cell that was 0");
            }
            assert!(ones(&torn) < last, "{tenths}");
            last = ones(&torn);
        }
        assert_eq!(torn(&program, &after, 0.0, 3), before);
        assert_eq!(torn(&program, &after, 1.0, 3), after);
    }

    #[test]
    fn a_torn_erase_falls_to_zero_first_and_then_rises() {
        let before = vec![0x5a; SECTOR];
        let after = vec![0xff; SECTOR];
        let erase = operation(Kind::Erase, before.clone());
        let share = |s: f64| ones(&torn(&erase, &after, s, 9)) as f64 / (8 * SECTOR) as f64;
        assert!((share(0.15) - 0.25).abs() < 0.02, "{}", share(0.15));
        assert!(share(0.3) < 0.02);
        assert!((share(0.65) - 0.5).abs() < 0.02);
        assert!(share(0.999) > 0.98);
    }

    #[test]
    fn units_before_are_done_and_units_after_untouched() {
        let erase = operation(Kind::Erase, vec![0x00; 4 * SECTOR]);
        let torn = torn(&erase, &vec![0xff; 4 * SECTOR], 0.6, 1);
        assert!(torn[..2 * SECTOR].iter().all(|b| *b == 0xff));
        assert!(torn[3 * SECTOR..].iter().all(|b| *b == 0x00));
        let middle = ones(&torn[2 * SECTOR..3 * SECTOR]);
        assert!((1..8 * SECTOR as u32).contains(&middle));
    }

    #[test]
    fn the_seed_decides() {
        let program = operation(Kind::Program, vec![0xff; 256]);
        let cut = |seed| torn(&program, &[0; 256], 0.5, seed);
        assert_eq!(cut(1), cut(1));
        assert_ne!(cut(1), cut(2));
    }
}
