//! The preamble gate: which of a word's 32 samples may be the first of a preamble?
//!
//! All 32 phases at once: each tap is the sample stream shifted so that bit `31 - s` of the tap is the sample that a preamble starting
//! at sample `s` must have high (a pulse) or low (a gap). A tap that disagrees is a miss. Misses are counted in unary (`one`, `two`, `three` say
//! that at least so many were seen), which needs five operations a tap and no more registers than the core has.
//!
//! ```text
//!          0   4   8   12  16  20  24  28  32  36  40  44  48  52  56  60
//!          ####    ####                ####    ####
//!   pulse   ^^      ^^                  ^ ^     ^ ^
//!   gap                    ^  ^  ^  ^                   ^   ^   ^   ^
//! ```
//! Two misses of 16 taps pass. The gaps right behind a pulse have no tap: a logarithmic detector falls slowly, and behind a threshold that still
//! follows the noise the first two pulses run into one. On noise that crosses the threshold all the time about 18 000 words a second
//! have a hit.
//!
//! Pulses come first: in silence two of them are missing everywhere and the word is left early.

/// The sample stream `N` samples on: samples `N..N + 32` counted from the first of `a`.
macro_rules! ahead {
    ($a:expr, $b:expr, $c:expr, $n:literal) => {
        if $n == 0 {
            $a
        } else if $n < 32 {
            ($a << ($n % 32)) | ($b >> ((32 - $n % 32) % 32))
        } else if $n == 32 {
            $b
        } else {
            ($b << ($n % 32)) | ($c >> ((64 - $n) % 32))
        }
    };
}

/// Phases of the word `a` at which a preamble may start, given the two words after it.
#[inline(always)]
pub(crate) fn gate(a: u32, b: u32, c: u32) -> u32 {
    let mut one = 0u32;
    let mut two = 0u32;
    let mut three = 0u32;
    macro_rules! miss {
        ($tap:expr) => {{
            let tap = $tap;
            three |= two & tap;
            two |= one & tap;
            one |= tap;
        }};
    }
    miss!(!ahead!(a, b, c, 1));
    miss!(!ahead!(a, b, c, 9));
    miss!(!ahead!(a, b, c, 29));
    miss!(!ahead!(a, b, c, 37));
    if three == u32::MAX {
        return 0;
    }
    miss!(!ahead!(a, b, c, 2));
    miss!(!ahead!(a, b, c, 10));
    miss!(!ahead!(a, b, c, 31));
    miss!(!ahead!(a, b, c, 39));
    miss!(ahead!(a, b, c, 15));
    miss!(ahead!(a, b, c, 18));
    miss!(ahead!(a, b, c, 21));
    miss!(ahead!(a, b, c, 24));
    miss!(ahead!(a, b, c, 43));
    miss!(ahead!(a, b, c, 47));
    miss!(ahead!(a, b, c, 51));
    // The last tap: nobody asks for `one` and `two` any more.
    !(three | two & ahead!(a, b, c, 55))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three words with a clean preamble at `start`.
    fn preamble(start: u32) -> [u32; 3] {
        let mut words = [0u32; 3];
        for pulse in [0, 8, 28, 36] {
            for sample in pulse..pulse + 4 {
                let at = start + sample;
                words[(at / 32) as usize] |= 1 << (31 - at % 32);
            }
        }
        words
    }

    #[test]
    fn a_clean_preamble_passes_at_every_phase() {
        for start in 0..32 {
            let [a, b, c] = preamble(start);
            assert_ne!(gate(a, b, c) & 1 << (31 - start), 0, "start {start}");
        }
    }

    #[test]
    fn stuck_levels_pass_nowhere() {
        assert_eq!(gate(0, 0, 0), 0);
        assert_eq!(gate(u32::MAX, u32::MAX, u32::MAX), 0);
    }
}
