//! The RP2040: two Cortex-M0+ cores around one [`bus::Bus`].
//!
//! The cores are in [`cpu`], each peripheral has a file of its own. This file joins them: boot as the mask ROM does it, slices of time,
//! sleep and wake, the start of core 1, resets.
//!
//! Scheduling: both cores run slices of at most [`SLICE`] cycles ahead of the peripherals, and every access to a peripheral first brings
//! all of them to that core's own time. Interrupts reach a running core at the end of its slice; a sleeping core wakes at the exact
//! cycle. When both sleep, time jumps from event to event. Nothing depends on the host's clock: the same input gives the same cycles.

use serde::{Deserialize, Serialize};
pub mod adc;
mod astray;
pub mod bus;
mod cdc_data;
mod clocks;
pub mod cpu;
pub mod crystal;
mod dma;
pub mod flash;
pub mod flash_journal;
mod flash_serial;
pub mod i2c;
pub mod outside;
pub mod pins;
pub mod pio;
mod power;
mod profile;
mod psm;
mod pwm;
mod qspi;
mod resets;
mod rom;
mod rom_start;
mod sio;
pub mod spi;
mod syscfg;
mod sysinfo;
mod systick;
mod time;
mod timer;
pub mod trace;
pub mod uart;
mod usb;
mod usb_control;
pub mod usb_host;
mod usb_strings;
pub mod usb_urbs;
mod vreg;
mod watchdog;

use bus::debug::Hit;
use bus::{Bus, Cause, Fault, Reader, ResetCause, Shadow, Uninitialised};
use cpu::{Cpu, Registers, Sleep, StackWatch};
use flash::Flash;
pub use profile::{Profile, Spent};

/// Most cycles a core runs ahead of the peripherals and of the other core.
const SLICE: u64 = 64;
/// Most cycles a slice lasts while both cores sleep.
const IDLE_SLICE: u64 = 1 << 20;
/// boot2: the first 256 bytes of flash run from the top of SRAM (datasheet 2.8.1.3.1).
const BOOT2: usize = 256;
const BOOT2_AT: u32 = 0x2004_1f00;

/// One core and how far it has run.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Core {
    pub(crate) cpu: Cpu,
    /// Cycles spent executing, that is not asleep.
    busy: u64,
    /// Held in reset or waiting in ROM for its start.
    stopped: bool,
    /// A ROM function that takes its time returns to its caller at this cycle.
    rom_until: Option<u64>,
}

impl Core {
    /// As after a reset at cycle `now`; what is known of its stack stays known.
    fn restart(&mut self, id: usize, now: u64) {
        let limit = self.cpu.stack.limit;
        let waits = self.cpu.waits;
        self.cpu = Cpu::new(id, now);
        self.cpu.waits = waits;
        self.cpu.stack.limit = limit;
        self.rom_until = None;
    }
}

/// A fault and where it happened.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{fault}; core {core} at {pc:#010x}, cycle {cycle}")]
pub struct Halt {
    pub fault: Fault,
    pub core: usize,
    pub pc: u32,
    pub cycle: u64,
}

/// A reset that happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResetEvent {
    pub cycle: u64,
    pub cause: ResetCause,
}

/// The chip.
#[derive(Clone, Serialize, Deserialize)]
pub struct Chip {
    pub(crate) cores: [Core; 2],
    pub bus: Bus,
    /// Words core 0 has sent to the core 1 that waits in ROM.
    launch: Vec<u32>,
    /// Resets since power-on, the power-on first.
    pub resets: Vec<ResetEvent>,
    /// Cycles spent at each instruction address, a table a core, while profiling.
    #[serde(skip)]
    profile: Option<Box<[Profile; 2]>>,
    /// A HardFault ends the run (otherwise the image's handler gets it, as on the chip).
    pub stop_at_hard_fault: bool,
}

impl Chip {
    /// Powers the chip on with these flash contents.
    pub fn new(flash: Flash) -> Self {
        let mut bus = Bus::new(flash);
        rom::write_header(&mut bus.rom);
        let core = |id| Core {
            cpu: Cpu::new(id, 0),
            busy: 0,
            stopped: id == 1,
            rom_until: None,
        };
        let mut chip = Self {
            cores: [core(0), core(1)],
            bus,
            launch: Vec::new(),
            resets: Vec::new(),
            profile: None,
            stop_at_hard_fault: true,
        };
        chip.reset(ResetCause::PowerOn);
        chip
    }

    /// Cycles since power-on, in system clocks of whatever rate was set.
    pub fn now(&self) -> u64 {
        self.bus.now
    }

    /// Busy cycles of each core since power-on.
    pub fn busy_cycles(&self) -> [u64; 2] {
        [self.cores[0].busy, self.cores[1].busy]
    }

    /// Puts `code` into SRAM at `at` and lets `core` run it with interrupts masked, `argument` in r0: for benchmarks and instruction tests.
    pub fn take_over(&mut self, core: usize, at: u32, code: &[u8], argument: u32) {
        let offset = (at - 0x2000_0000) as usize;
        self.bus.sram[offset..offset + code.len()].copy_from_slice(code);
        self.bus.watch_write(offset, code.len());
        let taken = &mut self.cores[core];
        taken.cpu = Cpu::new(core, self.bus.now);
        taken.cpu.regs.primask = 1;
        taken.cpu.regs.r[0] = argument;
        taken.cpu.regs.set_pc(at);
        taken.stopped = false;
        self.bus.asleep[core] = false;
        self.bus.wfe[core] = false;
        self.bus.wake_at[core] = None;
    }

    /// Starts to count cycles by instruction address. Costs about half of the speed.
    pub fn start_profile(&mut self) {
        self.profile = Some(Box::new([Profile::new(), Profile::new()]));
    }

    /// What was counted for each core since [`Chip::start_profile`].
    pub fn profile(&self) -> Option<&[Profile; 2]> {
        self.profile.as_deref()
    }

    /// From here on, remembers which bytes of SRAM are written and who reads others. What was written before counts as written if it is
    /// not zero. Costs speed.
    pub fn watch_uninitialised(&mut self) {
        let mut shadow = Box::new(Shadow::new());
        for (at, byte) in self.bus.sram.iter().enumerate() {
            if *byte != 0 {
                shadow.write(at, 1);
            }
        }
        self.bus.shadow = Some(shadow);
    }

    /// Who has read SRAM that nobody wrote, since [`Chip::watch_uninitialised`].
    pub fn uninitialised(&self) -> impl Iterator<Item = (Reader, Uninitialised)> + '_ {
        self.bus.shadow.iter().flat_map(|shadow| shadow.readers())
    }

    /// A core's stack must not grow below `lowest` from here on.
    pub fn set_stack_limit(&mut self, core: usize, lowest: u32) {
        self.cores[core].cpu.stack.limit = Some(lowest);
    }

    /// How deep a core's stack has been.
    pub fn stack(&self, core: usize) -> &StackWatch {
        &self.cores[core].cpu.stack
    }

    /// Cycles each core has waited for bus ports and for flash.
    pub fn wait_cycles(&self) -> [u64; 2] {
        [self.cores[0].cpu.waits, self.cores[1].cpu.waits]
    }

    /// A core's registers.
    pub fn registers(&self, core: usize) -> &Registers {
        &self.cores[core].cpu.regs
    }

    /// A core's registers, to be changed from outside; a new PC must be a halfword's address.
    pub fn registers_mut(&mut self, core: usize) -> &mut Registers {
        &mut self.cores[core].cpu.regs
    }

    /// Where a core is.
    pub fn program_counter(&self, core: usize) -> u32 {
        self.cores[core].cpu.regs.pc()
    }

    fn reset(&mut self, cause: ResetCause) {
        let now = self.bus.now;
        self.resets.push(ResetEvent { cycle: now, cause });
        self.bus.reset(cause);
        self.launch.clear();
        for (id, core) in self.cores.iter_mut().enumerate() {
            core.restart(id, now);
            core.stopped = id == 1;
        }
        // What the mask ROM does: check boot2's CRC-32, copy it to SRAM, run it with LR = 0.
        let boot2 = &self.bus.flash.bytes[..BOOT2];
        let stored = u32::from_le_bytes(boot2[BOOT2 - 4..].try_into().expect("four bytes"));
        if rom_start::boot2_crc(&boot2[..BOOT2 - 4]) != stored {
            self.bus.fault = Some(Fault::Boot2);
            return;
        }
        let at = (BOOT2_AT - 0x2000_0000) as usize;
        let (flash, sram) = (&self.bus.flash.bytes, &mut self.bus.sram);
        sram[at..at + BOOT2].copy_from_slice(&flash[..BOOT2]);
        self.bus.watch_write(at, BOOT2);
        self.cores[0].cpu.start(BOOT2_AT, BOOT2_AT);
    }

    /// Runs until cycle `until`, the first fault, the flash operation that the journal is to pause at, or what a debugger waits for
    /// ([`Chip::debug_hit`]).
    pub fn run_until(&mut self, until: u64) -> Result<(), Halt> {
        // Between runs anything may have been done to the peripherals.
        self.bus.settle();
        self.bus.paused = false;
        while self.bus.now < until
            && self.bus.fault.is_none()
            && !self.bus.paused
            && self.debug_hit().is_none()
        {
            self.slice(until);
        }
        match self.bus.fault.clone() {
            None => Ok(()),
            Some(fault) => {
                let core = self.bus.active;
                Err(Halt {
                    fault,
                    core,
                    pc: self.bus.active_pc,
                    cycle: self.bus.now,
                })
            }
        }
    }

    /// What a debugger waited for has happened.
    pub fn debug_hit(&self) -> Option<Hit> {
        self.bus.debug.as_ref().and_then(|debug| debug.hit)
    }

    fn slice(&mut self, until: u64) {
        let awake = [self.awake(0), self.awake(1)];
        if !awake[0] && !awake[1] {
            let end = until.min(self.bus.now + IDLE_SLICE);
            self.bus.update_lines();
            if self.bus.wake_at == [None; 2] {
                self.bus.advance_until(end, true);
            }
        } else {
            // Until the core that is behind has caught up, the other one waits.
            let behind = (0..2)
                .filter(|&k| awake[k])
                .map(|k| self.cores[k].cpu.time)
                .min();
            let start = behind.unwrap_or(self.bus.now);
            let end = until.min(start.max(self.bus.now) + SLICE);
            let first = self.bus.fabric.first();
            for k in [first, 1 - first] {
                if awake[k] {
                    self.run_core(k, end);
                }
            }
            self.bus.advance(end);
            self.bus.update_lines();
        }
        self.wake();
        self.after_slice();
    }

    fn awake(&self, k: usize) -> bool {
        !self.cores[k].stopped && !self.bus.asleep[k]
    }

    /// Runs core `k` to cycle `end`, or until it sleeps or asks for something that concerns the whole chip.
    fn run_core(&mut self, k: usize, end: u64) {
        let start = self.cores[k].cpu.time;
        self.bus.active = k;
        // The DMA went first where the program gave it priority.
        let owed = std::mem::take(&mut self.bus.fabric.owed[k]);
        self.cores[k].cpu.time += owed;
        self.cores[k].cpu.waits += owed;
        while self.cores[k].cpu.time < end && !self.stops_slice() {
            self.cores[k].cpu.take_pending(&mut self.bus);
            if self.waits_in_rom(k, end) {
                continue;
            }
            if self.profile.is_some() {
                self.step_profiled(k, end);
            } else {
                self.step(k, end);
            }
            self.bus.attention = false;
            if std::mem::take(&mut self.bus.rom_called) {
                self.call_rom(k);
            }
            if let Some(cause) = self.cores[k].cpu.fault.take() {
                self.hard_fault(k, cause);
            }
            if self.cores[k].cpu.sleep != Sleep::Awake {
                self.fall_asleep(k);
                break;
            }
        }
        let ran = self.cores[k].cpu.time - start;
        self.cores[k].busy += ran;
    }

    /// An instruction could not be completed.
    #[cold]
    fn hard_fault(&mut self, k: usize, cause: Cause) {
        let cpu = &mut self.cores[k].cpu;
        let pc = cpu.at;
        if self.stop_at_hard_fault || !cpu.enter_hard_fault(&mut self.bus) {
            let fault = Fault::HardFault { core: k, pc, cause };
            self.bus.fault.get_or_insert(fault);
        }
        self.bus.attention = false;
    }

    fn fall_asleep(&mut self, k: usize) {
        self.bus.asleep[k] = true;
        self.bus.wfe[k] = self.cores[k].cpu.sleep == Sleep::Event;
        self.bus.wake_at[k] = None;
        if self.bus.can_wake(k) {
            self.bus.wake_at[k] = Some(self.cores[k].cpu.time);
        }
    }

    /// Something happened that the slice of neither core may go past.
    fn stops_slice(&self) -> bool {
        self.bus.reset_request.is_some()
            || self.bus.core1_forced_off
            || self.bus.core1_launching
            || self.bus.paused
            || self.bus.fault.is_some()
            || self.debug_hit().is_some()
    }

    /// Instructions until cycle `end`, a sleep, or an access that wants attention.
    fn step(&mut self, k: usize, end: u64) {
        let cpu = &mut self.cores[k].cpu;
        if self.bus.shadow.is_some() || self.bus.debug.is_some() {
            cpu.run::<true>(&mut self.bus, end);
        } else {
            cpu.run::<false>(&mut self.bus, end);
        }
    }

    /// The same, an instruction at a time, counted.
    fn step_profiled(&mut self, k: usize, end: u64) {
        let before = (
            self.cores[k].cpu.time,
            self.cores[k].cpu.waits,
            self.bus.xip.misses[k],
        );
        self.step(k, end.min(before.0 + 1));
        let cpu = &self.cores[k].cpu;
        if let Some(profile) = &mut self.profile {
            let spent = profile::Spent {
                times: 1,
                cycles: cpu.time - before.0,
                waits: cpu.waits - before.1,
                misses: self.bus.xip.misses[k] - before.2,
            };
            profile[k].count(cpu.at, spent);
        }
    }

    /// Cores whose wake-up came go on at the cycle it came.
    fn wake(&mut self) {
        for k in 0..2 {
            if !self.bus.asleep[k] {
                continue;
            }
            if let Some(at) = self.bus.wake_at[k].take() {
                self.bus.asleep[k] = false;
                if self.bus.wfe[k] {
                    self.bus.wfe[k] = false;
                    self.bus.event[k] = false;
                }
                let cpu = &mut self.cores[k].cpu;
                cpu.sleep = Sleep::Awake;
                cpu.time = cpu.time.max(at);
            }
        }
    }

    fn after_slice(&mut self) {
        if self.bus.core1_forced_off {
            self.bus.core1_forced_off = false;
            let now = self.bus.now;
            self.cores[1].restart(1, now);
            self.cores[1].stopped = true;
            self.bus.asleep[1] = false;
            self.bus.wfe[1] = false;
            self.launch.clear();
            self.bus.sio.fifo = Default::default();
            // The ROM of core 1 announces itself with a zero (datasheet 2.8.2).
            self.bus.sio.fifo[0].push_back(0);
        }
        if self.bus.core1_launching {
            self.bus.core1_launching = false;
            if self.cores[1].stopped {
                self.listen_for_launch();
            }
        }
        if let Some(cause) = self.bus.reset_request.take() {
            let by_watchdog = cause != ResetCause::Software;
            if by_watchdog && !self.bus.psm.watchdog_resets_chip() {
                self.bus
                    .fault
                    .get_or_insert(Fault::PartialReset(self.bus.psm.watchdog_resets()));
                return;
            }
            self.reset(cause);
        }
    }
}

#[cfg(test)]
mod cost_tests;
#[cfg(test)]
pub(crate) mod test_chip;
#[cfg(test)]
#[path = "chip_tests.rs"]
mod tests;
#[cfg(test)]
mod trace_tests;
