//! How deep a core's stack has grown, and where it must not grow.
//!
//! The lowest stack pointer is noted where instructions lower it (PUSH, SUB SP, exception entry); the limit is compared only when a new
//! low is reached, so watching costs next to nothing.

use serde::{Deserialize, Serialize};

/// One core's stack.
#[derive(Clone, Default, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StackWatch {
    /// Where the stack pointer was set last by MSR, by the ROM or by the launch of core 1.
    pub top: u32,
    /// Lowest since then.
    pub lowest: u32,
    /// The stack's lowest address, where it is known; below it is a fault.
    pub limit: Option<u32>,
}

impl StackWatch {
    /// A stack starts at `top`.
    pub fn restart(&mut self, top: u32) {
        self.top = top;
        self.lowest = top;
    }

    /// Bytes used at most.
    pub fn used(&self) -> u32 {
        self.top.saturating_sub(self.lowest)
    }

    /// The stack pointer is now `sp`. Says whether that is below the limit.
    #[inline(always)]
    pub fn lower(&mut self, sp: u32) -> bool {
        if sp >= self.lowest {
            return false;
        }
        self.lowest = sp;
        self.limit
            .is_some_and(|limit| sp < limit && self.top >= limit)
    }
}
