//! What an instruction costs by ARM's table, where the CPU core taken from elsewhere charges something else.
//!
//! Source: Cortex-M0+ TRM (DDI 0484C), table 3.1: zero wait states, single-cycle multiplier; 3.8 for exception entry. The core of
//! `rp2040-emu` follows that table but for the rows below, so each step's figure is put right here.
//!
//! | instruction | the core | ARM |
//! |---|---|---|
//! | taken `b<cond>`, `b`, `bx`, `blx`, write to PC | 3 | 2 |
//! | `pop {…, pc}` of n words | n + 4 | n + 3 |
//! | `bl` | 4 | 3 |
//! | `mrs`, `msr` | 2 | 3 |
//! | `dmb`, `dsb`, `isb` | 1 | 3 |
//! | exception entry | 16 | 15 |
//!
//! An exception return is not in ARM's table: [`EXCEPTION_RETURN`] is an assumption. The access of a load or store to the single-cycle
//! I/O port is put right where the bus sees it ([`super::bus::Bus`]).

/// Cycles of exception entry (Cortex-M0+ TRM 3.8: 15 with zero wait states).
pub(super) const EXCEPTION_ENTRY: u32 = 15;
/// Cycles of exception return, the branch included. ARM gives none; eight loads and a pipeline refill take as long as the entry does
/// without its vector fetch (assumed).
pub(super) const EXCEPTION_RETURN: u32 = 13;
/// What the core shows as its address after it has entered or left an exception.
pub(super) const STACKING: u32 = 0xffff_fffe;
const UNSTACKING: u32 = 0xffff_fffd;
/// A wide instruction of any kind: `bl`, `mrs`, `msr` and the barriers all cost three.
const WIDE: u32 = 3;

/// Whether a step at `at` that went on to `after` and was charged `charged` may need [`corrected`]: neither the next instruction in line
/// nor the cost of a taken branch.
#[inline(always)]
pub(super) fn in_doubt(charged: u32, at: u32, after: u32) -> bool {
    after != at.wrapping_add(2) || charged == 3
}

/// ARM's figure for the step. `first` is the halfword at `at`, asked for only where the addresses do not tell.
pub(super) fn corrected(charged: u32, at: u32, after: u32, first: impl FnOnce() -> u16) -> u32 {
    match at {
        // Entered: after a synchronous instruction (SVC, a fault), instead of one (an interrupt), or behind a return (tail-chained).
        STACKING => charged.max(16) - 1,
        UNSTACKING => EXCEPTION_RETURN,
        // The next in line at the cost of a branch: two registers stored or loaded, or a branch to where it would go anyway.
        _ if after == at.wrapping_add(2) => match first() >> 12 {
            0xd | 0xe => charged - 1,
            0x4 => charged - 1,
            _ => charged,
        },
        _ if after == at.wrapping_add(4) && first() >> 11 == 0b11110 => WIDE,
        _ => charged - 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_of_registers_is_no_branch() {
        let halfword = |value| move || value;
        assert_eq!(corrected(3, 0, 2, halfword(0xb403)), 3, "push {{r0, r1}}");
        assert_eq!(corrected(3, 0, 2, halfword(0xe7ff)), 2, "b .+2");
        assert_eq!(corrected(3, 0, 2, halfword(0xd1ff)), 2, "bne .+2");
        assert_eq!(corrected(3, 0, 4, halfword(0xe000)), 2, "b .+4");
        assert_eq!(corrected(1, 0, 4, halfword(0xf3bf)), 3, "dmb");
        assert_eq!(corrected(4, 0, 400, halfword(0xf000)), 3, "bl");
    }
}
