//! The RP2040: two Cortex-M0+ cores around one [`bus::Bus`].
//!
//! The instruction set comes from `rp2040-emu`; everything around it is modelled here, a file a peripheral. What this file adds to the
//! cores: boot as the mask ROM does it, preemption between interrupt priorities, sleep and wake, the start of core 1, resets.
//!
//! Scheduling: both cores run slices of at most [`SLICE`] cycles ahead of the peripherals, and every access to a peripheral first brings
//! all of them to that core's own time. Interrupts reach a running core at the end of its slice; a sleeping core wakes at the exact
//! cycle. When both sleep, time jumps from event to event. Nothing depends on the host's clock: the same input gives the same cycles.

pub mod adc;
pub mod bus;
mod clocks;
pub mod crystal;
mod cycles;
mod dma;
pub mod flash;
pub mod i2c;
pub mod outside;
pub mod pins;
pub mod pio;
mod profile;
mod pwm;
mod rom;
mod sio;
mod time;
mod timer;
mod uart;
mod usb;
pub mod usb_host;

use bus::{Bus, Fault, ResetCause};
use flash::Flash;
pub use profile::Profile;
use rp2040_emu::CortexM0Plus;
use rp2040_emu::core::CoreBus;

/// Most cycles a core runs ahead of the peripherals and of the other core.
const SLICE: u64 = 64;
/// Most cycles a slice lasts while both cores sleep.
const IDLE_SLICE: u64 = 1 << 20;
/// boot2: the first 256 bytes of flash run from the top of SRAM (datasheet 2.8.1.3.1).
const BOOT2: usize = 256;
const BOOT2_AT: u32 = 0x2004_1f00;
/// PSM bits a whole-chip watchdog reset selects: all but the two oscillators.
const WHOLE_CHIP: u32 = 0x1_fffc;

/// One core and how far it has run.
pub(crate) struct Core {
    pub(crate) cpu: CortexM0Plus,
    pub(crate) time: u64,
    /// Cycles spent executing, that is not asleep.
    busy: u64,
    /// Held in reset or waiting in ROM for its start.
    stopped: bool,
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResetEvent {
    pub cycle: u64,
    pub cause: ResetCause,
}

/// The chip.
pub struct Chip {
    pub(crate) cores: [Core; 2],
    pub bus: Bus,
    /// Words core 0 has sent to the core 1 that waits in ROM.
    launch: Vec<u32>,
    /// Resets since power-on, the power-on first.
    pub resets: Vec<ResetEvent>,
    /// Cycles spent at each instruction address, a table a core, while profiling.
    profile: Option<Box<[Profile; 2]>>,
}

impl Chip {
    /// Powers the chip on with these flash contents.
    pub fn new(flash: Flash) -> Self {
        let mut bus = Bus::new(flash);
        rom::write_header(&mut bus.rom);
        let core = |id| Core {
            cpu: CortexM0Plus::with_id(id),
            time: 0,
            busy: 0,
            stopped: id == 1,
        };
        let mut chip = Self {
            cores: [core(0), core(1)],
            bus,
            launch: Vec::new(),
            resets: Vec::new(),
            profile: None,
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
        let time = self.bus.now;
        let taken = &mut self.cores[core];
        taken.cpu = CortexM0Plus::with_id(core as u8);
        taken.cpu.regs.primask = 1;
        taken.cpu.regs.r[0] = argument;
        taken.cpu.regs.set_pc(at);
        taken.time = time;
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
            core.cpu = CortexM0Plus::with_id(id as u8);
            core.time = now;
            core.stopped = id == 1;
        }
        // What the mask ROM does: check boot2's CRC-32, copy it to SRAM, run it with LR = 0.
        let boot2 = &self.bus.flash.bytes[..BOOT2];
        let stored = u32::from_le_bytes(boot2[BOOT2 - 4..].try_into().expect("four bytes"));
        if boot2_crc(&boot2[..BOOT2 - 4]) != stored {
            self.bus.fault = Some(Fault::Boot2);
            return;
        }
        let at = (BOOT2_AT - 0x2000_0000) as usize;
        let (flash, sram) = (&self.bus.flash.bytes, &mut self.bus.sram);
        sram[at..at + BOOT2].copy_from_slice(&flash[..BOOT2]);
        let regs = &mut self.cores[0].cpu.regs;
        regs.msp = BOOT2_AT;
        regs.r[13] = BOOT2_AT;
        regs.r[14] = 0;
        regs.set_pc(BOOT2_AT);
    }

    /// Runs until cycle `until` or the first fault.
    pub fn run_until(&mut self, until: u64) -> Result<(), Halt> {
        while self.bus.now < until && self.bus.fault.is_none() {
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
                .map(|k| self.cores[k].time)
                .min();
            let start = behind.unwrap_or(self.bus.now);
            let end = until.min(start.max(self.bus.now) + SLICE);
            for (k, awake) in awake.into_iter().enumerate() {
                if awake {
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
        let start = self.cores[k].time;
        self.bus.active = k;
        while self.cores[k].time < end && !self.stops_slice() {
            if self.bus.ppb[k].active != 0 && self.bus.nvic[k].pending_and_enabled() != 0 {
                self.preempt(k);
            }
            let before = self.bus.ppb[k].active;
            if self.profile.is_some() {
                self.step_profiled(k, end);
            } else {
                self.step(k, end);
            }
            self.bus.attention = false;
            if std::mem::take(&mut self.bus.rom_called) {
                self.call_rom(k);
            }
            if before != self.bus.ppb[k].active {
                // Exception entry and return set the event register (ARMv6-M B1.5.18).
                self.bus.event[k] = true;
                if self.cores[k].cpu.is_in_hardfault() {
                    let pc = self.faulting_pc(k);
                    self.bus
                        .fault
                        .get_or_insert(Fault::HardFault { core: k, pc });
                }
            }
            if !self.bus.stale_code.is_empty() {
                let stale = std::mem::take(&mut self.bus.stale_code);
                for core in &mut self.cores {
                    core.cpu.invalidate_decode_cache_entries(&stale);
                }
            }
            if self.cores[k].cpu.is_halted() && self.bus.active_pc == cycles::STACKING {
                // Locked up: the HardFault vector leads nowhere. Only WFI may halt a core.
                let pc = self.faulting_pc(k);
                let fault = Fault::HardFault { core: k, pc };
                self.bus.fault.get_or_insert(fault);
                break;
            }
            if self.cores[k].cpu.is_halted() || self.bus.wfe[k] {
                self.bus.asleep[k] = true;
                self.bus.wake_at[k] = None;
                if self.bus.can_wake(k) {
                    self.bus.wake_at[k] = Some(self.cores[k].time);
                }
                break;
            }
        }
        let ran = self.cores[k].time - start;
        self.cores[k].busy += ran;
    }

    /// Something happened that the slice of neither core may go past.
    fn stops_slice(&self) -> bool {
        self.bus.reset_request.is_some()
            || self.bus.core1_forced_off
            || self.bus.core1_launching
            || self.bus.fault.is_some()
    }

    /// The inner loop: instructions until cycle `end`, a sleep, or an access that wants attention.
    fn step(&mut self, k: usize, end: u64) {
        let core = &mut self.cores[k];
        let bus = &mut self.bus;
        while core.time < end {
            bus.core_time = core.time;
            let mut charged = core.cpu.step(bus).max(1);
            let (at, after) = (bus.active_pc, core.cpu.regs.pc());
            if cycles::in_doubt(charged, at, after) {
                charged = cycles::corrected(charged, at, after, || bus.halfword(at));
            }
            core.time += u64::from(charged);
            if bus.attention || core.cpu.is_halted() {
                core.time -= std::mem::take(&mut bus.single_cycle_accesses);
                return;
            }
        }
    }

    /// The same, an instruction at a time, counted.
    fn step_profiled(&mut self, k: usize, end: u64) {
        let before = self.cores[k].time;
        self.step(k, end.min(before + 1));
        let cycles = self.cores[k].time - before;
        if let Some(profile) = &mut self.profile {
            profile[k].count(self.bus.active_pc, cycles);
        }
    }

    /// The stacked return address of the exception a core has just entered.
    fn faulting_pc(&mut self, k: usize) -> u32 {
        let frame = self.cores[k].cpu.regs.msp;
        self.bus.read32(frame.wrapping_add(24))
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
                let core = &mut self.cores[k];
                core.cpu.wake();
                core.time = core.time.max(at);
            }
        }
    }

    fn after_slice(&mut self) {
        if self.bus.core1_forced_off {
            self.bus.core1_forced_off = false;
            let core = &mut self.cores[1];
            core.cpu = CortexM0Plus::with_id(1);
            core.stopped = true;
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
            if by_watchdog && self.bus.psm_wdsel & WHOLE_CHIP != WHOLE_CHIP {
                self.bus
                    .fault
                    .get_or_insert(Fault::PartialReset(self.bus.psm_wdsel));
                return;
            }
            self.reset(cause);
        }
    }

    /// Core 1 in ROM answers each word of the launch sequence 0, 0, 1, VTOR, SP, PC with itself (datasheet 2.8.2).
    fn listen_for_launch(&mut self) {
        const PREFIX: [u32; 3] = [0, 0, 1];
        while let Some(word) = self.bus.sio.fifo[1].pop_front() {
            self.bus.sio.fifo[0].push_back(word);
            let n = self.launch.len();
            if n < PREFIX.len() && PREFIX[n] != word {
                self.launch.clear();
                if word == 0 {
                    self.launch.push(0);
                }
                continue;
            }
            self.launch.push(word);
            if let [_, _, _, vtor, sp, pc] = self.launch[..] {
                self.launch.clear();
                let starts = self.bus.now.max(self.cores[0].time);
                let core = &mut self.cores[1];
                core.cpu = CortexM0Plus::with_id(1);
                core.cpu.regs.msp = sp;
                core.cpu.regs.r[13] = sp;
                core.cpu.regs.set_pc(pc & !1);
                core.time = starts;
                core.stopped = false;
                self.bus.ppb[1].vtor = vtor;
                self.bus.asleep[1] = false;
                self.bus.wfe[1] = false;
                self.bus.event[1] = true;
            }
        }
        self.bus.event[0] = true;
        self.bus.update_lines();
    }

    /// Takes an interrupt of higher priority while a handler runs, which the CPU core itself does not.
    #[cold]
    fn preempt(&mut self, k: usize) {
        let active = self.bus.ppb[k].active;
        // NMI and HardFault cannot be preempted by interrupts.
        if self.cores[k].cpu.regs.primask & 1 != 0 || active & 0b1100 != 0 {
            return;
        }
        let Some((irq, priority)) = self.bus.nvic[k].highest_priority_pending() else {
            return;
        };
        let running = (4..48u16)
            .filter(|e| active & (1 << e) != 0)
            .map(|e| match e {
                16.. => self.bus.nvic[k].priority[usize::from(e - 16)] & 0xc0,
                _ => self.bus.ppb[k].exception_priority(e) as u8,
            })
            .min();
        if running.is_some_and(|running| priority >= running) {
            return;
        }
        let regs = &self.cores[k].cpu.regs;
        let sp = regs.r[13];
        let frame = (sp - 32) & !4;
        let aligned = u32::from(sp & 4 != 0) << 9;
        let stacked = [
            regs.r[0],
            regs.r[1],
            regs.r[2],
            regs.r[3],
            regs.r[12],
            regs.r[14],
            regs.pc(),
            regs.xpsr & !(1 << 9) | aligned,
        ];
        for (i, word) in stacked.into_iter().enumerate() {
            self.bus.write32(frame + 4 * i as u32, word);
        }
        let exception = 16 + u32::from(irq);
        let vector = self.bus.read32(self.bus.ppb[k].vtor + 4 * exception);
        let core = &mut self.cores[k];
        core.cpu.regs.r[13] = frame;
        core.cpu.regs.msp = frame;
        core.cpu.regs.r[14] = 0xffff_fff1;
        core.cpu.regs.xpsr = core.cpu.regs.xpsr & !0x1ff | exception;
        core.cpu.regs.set_pc(vector & !1);
        core.time += u64::from(cycles::EXCEPTION_ENTRY);
        self.bus.ppb[k].mark_active(exception as u16);
        self.bus.nvic[k].clear_pending(irq);
    }
}

/// CRC-32 of boot2: polynomial 04C11DB7, initial ones, not reflected, no final inversion (datasheet 2.8.1.3.1).
fn boot2_crc(bytes: &[u8]) -> u32 {
    bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 24, |crc, _| {
            if crc & 1 << 31 != 0 {
                crc << 1 ^ 0x04c1_1db7
            } else {
                crc << 1
            }
        })
    })
}

#[cfg(test)]
mod test_chip;
#[cfg(test)]
#[path = "chip_tests.rs"]
mod tests;
