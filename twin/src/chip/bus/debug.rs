//! Breakpoints, watchpoints and single steps, for a debugger outside.
//!
//! A core stops before it executes an instruction with a breakpoint, and behind one whose access met a watchpoint. Only while a debugger is
//! attached is any of this looked at.

use std::collections::BTreeSet;

use super::{Bus, SRAM_BASE};

/// What a watchpoint waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WatchFor {
    Write,
    Read,
    Access,
}

/// A watched range of SRAM.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Watchpoint {
    pub address: u32,
    pub len: u32,
    pub what: WatchFor,
}

/// Why the chip stopped for the debugger, and which core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit {
    pub core: usize,
    pub reason: Reason,
}

/// The reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    Breakpoint,
    Step,
    Watchpoint(Watchpoint),
}

/// What the debugger has asked for.
#[derive(Clone, Default)]
pub struct Debug {
    pub breakpoints: BTreeSet<u32>,
    pub watchpoints: BTreeSet<Watchpoint>,
    /// The core that is to execute one instruction.
    pub step: Option<usize>,
    /// Since the last [`Debug::go_on`].
    pub hit: Option<Hit>,
    /// A core goes on from a breakpoint: it may execute this instruction.
    passing: [Option<u32>; 2],
}

impl Debug {
    /// The cores, which stand at `pc`, go on.
    pub fn go_on(&mut self, pc: [u32; 2]) {
        self.hit = None;
        self.passing = pc.map(Some);
    }

    /// Core `core` is about to execute at `pc`: whether it must not.
    pub fn stops_before(&mut self, core: usize, pc: u32) -> bool {
        let passing = self.passing[core].take() == Some(pc);
        if !passing && self.breakpoints.contains(&pc) {
            let reason = Reason::Breakpoint;
            self.hit.get_or_insert(Hit { core, reason });
        }
        self.hit.is_some()
    }

    /// Core `core` has executed an instruction: whether it must stop.
    pub fn stops_behind(&mut self, core: usize) -> bool {
        if self.step == Some(core) {
            self.step = None;
            let reason = Reason::Step;
            self.hit.get_or_insert(Hit { core, reason });
        }
        self.hit.is_some()
    }

    fn accessed(&mut self, core: usize, at: usize, len: usize, write: bool) {
        let (from, to) = (SRAM_BASE + at as u32, SRAM_BASE + (at + len) as u32);
        let met = self.watchpoints.iter().find(|w| {
            let wanted = match w.what {
                WatchFor::Write => write,
                WatchFor::Read => !write,
                WatchFor::Access => true,
            };
            wanted && from < w.address + w.len && w.address < to
        });
        if let Some(&watchpoint) = met {
            let reason = Reason::Watchpoint(watchpoint);
            self.hit.get_or_insert(Hit { core, reason });
        }
    }
}

impl Bus {
    /// A core accesses SRAM, while it is watched.
    pub fn debug_access(&mut self, core: usize, at: usize, len: usize, write: bool) {
        if let Some(debug) = &mut self.debug {
            debug.accessed(core, at, len, write);
        }
    }
}
