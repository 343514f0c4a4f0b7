//! The thirty pads of bank 0: what drives each one, and what the chip reads back.
//!
//! Source: RP2040 datasheet 2.19 (GPIO), register tables IO_BANK0 and PADS_BANK0.
//!
//! | IO_BANK0 | register | | PADS_BANK0 | register |
//! |---|---|---|---|---|
//! | 8n | GPIOn_STATUS | | 00 | VOLTAGE_SELECT |
//! | 8n+4 | GPIOn_CTRL | | 4+4n | GPIOn: slew 0, Schmitt 1, PDE 2, PUE 3, drive 5:4, IE 6, OD 7 |
//! | f0-fc | INTR0-3 | | 7c 80 | SWCLK SWD |
//! | 100-12c | PROC0 INTE INTF INTS | | | |
//! | 130-15c | PROC1 INTE INTF INTS | | | |
//! | 160-18c | DORMANT_WAKE INTE INTF INTS | | | |
//!
//! ```text
//!   function ─ OUTOVER, OEOVER ─▶ pad ◀─ outside: driven, or held low and pulled up (open drain)
//!   readers  ◀─ INOVER ◀─ IE ◀──── level: own output, else outside, else PUE, PDE, or both: what it was
//! ```
//! A pin held low by an open-drain device is low whatever drives it. A pad without a pull and without anything that drives it reads low.
//! Slew rate, Schmitt trigger and drive strength are stored without effect; the pads of the debug port too.
//!
//! PULSES is the one fast input. Its edges come from a [`PulseSource`] as picoseconds of playback and are turned into system cycles by
//! [`edge_tick`]; a reader at cycle `c` sees the level two cycles earlier, behind the input synchroniser (datasheet 3.5.6.3). Every other
//! pin changes only between the slices in which the chip runs. A pin that drives itself is read back without the synchroniser's delay.

mod choices;
pub mod functions;
mod playback;
mod registers;

use crate::front_end::PulseSource;
use choices::Choices;
use functions as f;
use playback::Playback;

/// Number of pads in bank 0.
pub const PADS: usize = 30;
/// Flip-flops between a pad and its reader (datasheet 3.5.6.3).
pub const SYNC_CYCLES: u64 = 2;
/// Pad registers after reset: input enabled, pulled down, 4 mA, Schmitt trigger.
const PAD_RESET: u32 = 0x56;
/// The same of SWCLK and SWD.
const DEBUG_PADS_RESET: [u32; 2] = [0xda, 0x5a];
/// Who listens to pin events.
const LISTENERS: usize = 3;

/// Pads, function multiplexers and their interrupts.
#[derive(Default)]
pub struct Pins {
    ctrl: [u32; PADS],
    pads: [u32; PADS],
    debug_pads: [u32; 2],
    voltage_select: u32,
    chosen: Choices,
    /// Levels from outside, and which pins something outside drives.
    external: u32,
    driven: u32,
    /// Pins with a resistor to the supply outside, and pins an open-drain device holds low.
    pulled_up_outside: u32,
    held_low: u32,
    /// Outputs before and after their overrides.
    offered_out: u32,
    offered_oe: u32,
    out: u32,
    oe: u32,
    /// Resolved level of every pad, and what readers see of it.
    level: u32,
    seen: u32,
    intr: [u32; 4],
    /// Enables and forced bits of core 0, core 1 and dormant wake.
    inte: [[u32; 4]; LISTENERS],
    intf: [[u32; 4]; LISTENERS],
    playback: Option<Playback>,
    /// Cycle from which the next playback edge is visible behind the synchroniser.
    next_visible: u64,
}

/// What the peripherals offer to the multiplexer: levels and output enables, spread over the pins that can carry them.
#[derive(Clone, Copy, Default)]
pub struct Drivers {
    pub sio: (u32, u32),
    pub pio: [(u32, u32); 2],
    pub spi: (u32, u32),
    pub uart: (u32, u32),
    /// Pins the I2C controllers pull low; they never drive high.
    pub i2c_low: u32,
    pub pwm: (u32, u32),
    pub clock: (u32, u32),
}

impl Pins {
    /// Pads as they leave reset, nothing attached.
    pub fn new() -> Self {
        let mut pins = Self {
            next_visible: u64::MAX,
            ..Self::default()
        };
        pins.reset();
        pins
    }

    fn choose(&mut self) {
        self.chosen = Choices::of(&self.ctrl, &self.pads);
    }

    // ---- outside -----------------------------------------------------------------------------------------------------------

    /// Plays `source` into `pin`, its time zero at cycle `start`. Replaces what played before.
    pub fn play(&mut self, source: Box<dyn PulseSource + Send>, pin: u32, start: u64) {
        self.driven |= 1 << pin;
        self.external &= !(1 << pin);
        self.playback = Some(Playback::new(source, pin, start));
        self.next_visible = u64::MAX;
        self.resolve_levels();
    }

    /// The source has no further edges and all it gave were played.
    pub fn playback_finished(&self) -> bool {
        self.playback.as_ref().is_none_or(Playback::finished)
    }

    /// Hands the trigger level to the front end, millivolts.
    pub fn set_trigger_level_mv(&mut self, millivolts: f64) {
        if let Some(p) = &mut self.playback {
            p.source.set_trigger_level_mv(millivolts);
        }
    }

    /// Makes sure that all edges up to cycle `until` are at hand.
    pub fn look_ahead(&mut self, until: u64) {
        let Some(p) = &mut self.playback else { return };
        p.look_ahead(until);
        self.next_visible = p.next_visible();
    }

    /// Sets an input from outside the chip.
    pub fn drive(&mut self, pin: u32, level: bool) {
        self.driven |= 1 << pin;
        if level {
            self.external |= 1 << pin;
        } else {
            self.external &= !(1 << pin);
        }
        self.resolve_levels();
    }

    /// Nothing outside drives the pin any longer.
    pub fn release(&mut self, pin: u32) {
        self.driven &= !(1 << pin);
        self.resolve_levels();
    }

    /// An open-drain device on the pins of `mask`, with a resistor to the supply, holds those in `low` low. True if that is news.
    pub fn open_drain(&mut self, mask: u32, low: u32) -> bool {
        let held = self.held_low & !mask | low & mask;
        let news = held != self.held_low || self.pulled_up_outside & mask != mask;
        if news {
            self.held_low = held;
            self.pulled_up_outside |= mask;
            self.resolve_levels();
        }
        news
    }

    // ---- levels ------------------------------------------------------------------------------------------------------------

    /// Input levels as a reader at cycle `now` sees them. Pins in `bypass` skip the synchroniser; for the playback pin that is exact only
    /// between its edges.
    #[inline]
    pub fn synced(&mut self, now: u64, bypass: u32) -> u32 {
        if now >= self.next_visible || bypass != 0 {
            self.pass_edges(now, bypass);
        }
        self.seen
    }

    #[cold]
    fn pass_edges(&mut self, now: u64, bypass: u32) {
        let Some(p) = &mut self.playback else { return };
        let bit = 1 << p.pin;
        let delay = if bypass & bit != 0 { 0 } else { SYNC_CYCLES };
        let before = self.external;
        for &(at, level) in &p.edges[p.played..] {
            if at + delay > now {
                break;
            }
            p.played += 1;
            if level != (self.external & bit != 0) {
                self.external ^= bit;
                let sensed = self.chosen.irq.apply(self.external);
                let event = if sensed & bit != 0 { 8 } else { 4 };
                self.intr[p.pin as usize / 8] |= event << (4 * (p.pin % 8));
            }
        }
        self.next_visible = p.next_visible();
        if self.external != before {
            let open = bit & !self.oe;
            self.level = self.level & !open | self.external & open;
            self.seen = self.visible();
        }
    }

    /// What readers see of the levels.
    fn visible(&self) -> u32 {
        self.chosen
            .input
            .apply(self.level & self.chosen.input_enabled)
    }

    /// Recomputes the outputs from what the peripherals drive.
    pub fn resolve(&mut self, drivers: &Drivers) {
        let on = &self.chosen.selected;
        let (mut out, mut oe) = (0, on[f::I2C] & drivers.i2c_low);
        for (function, (levels, enables)) in [
            (f::SPI, drivers.spi),
            (f::UART, drivers.uart),
            (f::PWM, drivers.pwm),
            (f::SIO, drivers.sio),
            (f::PIO0, drivers.pio[0]),
            (f::PIO1, drivers.pio[1]),
            (f::CLOCK, drivers.clock),
        ] {
            out |= on[function] & levels;
            oe |= on[function] & enables;
        }
        (self.offered_out, self.offered_oe) = (out, oe);
        self.out = self.chosen.out.apply(out);
        self.oe = self.chosen.oe.apply(oe) & !self.chosen.output_disabled;
        self.resolve_levels();
    }

    fn resolve_levels(&mut self) {
        let (up, down) = (self.chosen.pull_up, self.chosen.pull_down);
        // A resistor outside is stronger than the pad's pulls; both of those at once keep the last level.
        let pulled = self.pulled_up_outside | up & (!down | self.level);
        let outside = (self.external & self.driven) | (pulled & !self.driven);
        self.level = ((self.out & self.oe) | (outside & !self.oe)) & !self.held_low;
        let before = self.chosen.irq.apply(self.seen);
        self.seen = self.visible();
        let sensed = self.chosen.irq.apply(self.seen);
        let mut changed = before ^ sensed;
        while changed != 0 {
            let n = changed.trailing_zeros() as usize;
            changed &= changed - 1;
            let rising = sensed & (1 << n) != 0;
            if n < PADS {
                self.intr[n / 8] |= if rising { 8 } else { 4 } << (4 * (n % 8));
            }
        }
    }

    /// Function selected for a pin.
    pub fn function(&self, pin: usize) -> u32 {
        self.ctrl[pin] & 0x1f
    }

    /// Level of a pad as it is now, from either side.
    pub fn level(&self, pin: u32) -> bool {
        self.level & (1 << pin) != 0
    }

    /// Levels of all pads as they are now.
    pub fn levels(&self) -> u32 {
        self.level
    }

    /// What a peripheral's input sees: the levels of the pins among `candidates` that select `function`, ORed; low if there is none.
    pub fn peripheral_input(&self, function: usize, candidates: u32) -> bool {
        self.chosen.selected[function] & candidates & self.seen != 0
    }

    /// Pins among `candidates` that select `function`.
    pub fn selected(&self, function: usize, candidates: u32) -> u32 {
        self.chosen.selected[function] & candidates
    }

    // ---- interrupts --------------------------------------------------------------------------------------------------------

    /// Interrupt bits with the level-sensitive ones filled in.
    fn raw_interrupts(&self, group: usize) -> u32 {
        let mut bits = self.intr[group];
        let sensed = self.chosen.irq.apply(self.seen);
        for i in 0..8 {
            let n = group * 8 + i;
            if n < PADS {
                bits |= if sensed & (1 << n) != 0 { 2 } else { 1 } << (4 * i);
            }
        }
        bits
    }

    /// IO_IRQ_BANK0 for one core.
    pub fn irq_line(&self, core: usize) -> bool {
        (0..4).any(|g| {
            (self.inte[core][g] != 0 || self.intf[core][g] != 0)
                && (self.raw_interrupts(g) & self.inte[core][g] | self.intf[core][g]) != 0
        })
    }
}
