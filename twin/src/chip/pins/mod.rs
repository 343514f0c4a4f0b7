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
//! PULSES is the one fast input: its edges come from `playback` with their cycles. A reader at cycle `c` sees the level two cycles
//! earlier, behind the input synchroniser (datasheet 3.5.6.3); so it does with what is attached and changes a level at a cycle of its own
//! ([`Pins::change_at`]), and with every other pin, one that the chip drives itself included. Inputs of UART, SPI and I2C and the
//! interrupt bits see those others at once.

use serde::{Deserialize, Serialize};
mod again;
mod choices;
pub mod functions;
mod playback;
mod registers;
mod synchroniser;

use std::collections::VecDeque;

use super::crystal::Crystal;
use crate::front_end::PulseSource;
use crate::front_end::trigger_level::TriggerLevel;
pub use again::Again;
use again::Repeated;
use choices::Choices;
use functions as f;
use playback::Playback;
use synchroniser::Synchroniser;

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
#[derive(Clone, Default, Serialize, Deserialize)]
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
    /// Levels that change at a cycle: cycle, pin, level.
    changes: VecDeque<(u64, u32, bool)>,
    /// Cycle from which the next edge of either is visible behind the synchroniser.
    next_visible: u64,
    /// System clock, and the threshold behind its RC.
    hz: u64,
    trigger_level: TriggerLevel,
    /// Pins with edges of their own cycles; the others pass through this.
    edged: u32,
    sync: Synchroniser,
    /// Cycle from which readers see [`Pins::seen`].
    settled_at: u64,
    /// The cycle at which whatever happens here happens; the bus keeps it.
    pub now: u64,
    /// Pins of which somebody wants every edge at its cycle.
    watch: u32,
}

/// What is to be played.
pub enum Played {
    Once(Box<dyn PulseSource + Send>),
    /// So that copies of the chip can hear it too.
    Again(Again),
}

/// What the peripherals offer to the multiplexer: levels and output enables, spread over the pins that can carry them.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
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
            hz: crate::board::TICK_HZ,
            ..Self::default()
        };
        pins.reset();
        pins
    }

    fn choose(&mut self) {
        self.chosen = Choices::of(&self.ctrl, &self.pads);
    }

    // ---- outside -----------------------------------------------------------------------------------------------------------

    /// Plays `source` into `pin`, its time zero at cycle `start`, which is nominal time `start_ps`. Replaces what played before.
    pub fn play(
        &mut self,
        source: Played,
        pin: u32,
        start: u64,
        start_ps: u128,
        crystal: &Crystal,
    ) {
        self.driven |= 1 << pin;
        self.edged |= 1 << pin;
        self.external &= !(1 << pin);
        let source = match source {
            Played::Once(source) => Repeated::once(source),
            Played::Again(again) => Repeated::again(again),
        };
        let mut playback = Playback::new(source, pin, start, start_ps, crystal.clone());
        playback.clock_changed(start, self.hz);
        self.playback = Some(playback);
        self.note_next_visible();
        self.resolve_levels();
    }

    /// Something plays.
    pub fn plays(&self) -> bool {
        self.playback.is_some()
    }

    /// Gives a chip that was read from a snapshot the source that it was playing. False if it is another one.
    pub fn resume_playback(&mut self, again: &Again) -> bool {
        self.playback.as_mut().is_none_or(|p| p.resume(again))
    }

    /// Whether what plays, if anything does, can be repeated for a copy of the chip.
    pub fn playback_repeatable(&self) -> bool {
        self.playback.as_ref().is_none_or(Playback::is_repeatable)
    }

    /// The source has no further edges and all it gave were played.
    pub fn playback_finished(&self) -> bool {
        self.playback.as_ref().is_none_or(Playback::finished)
    }

    /// The trigger level as it goes on from now; the front end follows it from what it has not produced yet.
    pub fn set_trigger_level(&mut self, level: TriggerLevel) {
        self.trigger_level = level;
    }

    /// The detector's output at cycle `now`, mV, while something plays.
    pub fn detector_mv(&self, now: u64) -> Option<f32> {
        self.playback.as_ref()?.detector_mv(now)
    }

    /// Cycles since playback time zero; of the chip's own when nothing is played.
    pub fn since_playback(&self, now: u64) -> u64 {
        let start = self.playback.as_ref().map_or(0, |p| p.started_at());
        now.wrapping_sub(start)
    }

    /// The system clock has another rate from cycle `now`.
    pub fn clock_changed(&mut self, now: u64, hz: u64) {
        self.hz = hz;
        if let Some(playback) = &mut self.playback {
            playback.clock_changed(now, hz);
        }
        self.note_next_visible();
    }

    /// Time passes without cycles.
    pub fn skip_ps(&mut self, now: u64, ps: u64) {
        if let Some(playback) = &mut self.playback {
            playback.skip_ps(now, ps);
        }
        self.note_next_visible();
    }

    /// Makes sure that all edges up to cycle `until` are at hand.
    pub fn look_ahead(&mut self, until: u64) {
        if let Some(playback) = &mut self.playback
            && playback.lacks(until)
        {
            playback.look_ahead(until, &self.trigger_level);
            self.note_next_visible();
        }
    }

    /// Something outside changes the level of `pin` at cycle `at`, which is not before the last such cycle.
    pub fn change_at(&mut self, pin: u32, level: bool, at: u64) {
        self.driven |= 1 << pin;
        self.edged |= 1 << pin;
        self.changes.push_back((at, pin, level));
        self.note_next_visible();
    }

    /// Cycle at which the next change made by something outside becomes visible.
    pub fn next_change(&self) -> u64 {
        self.changes
            .front()
            .map_or(u64::MAX, |change| change.0 + SYNC_CYCLES)
    }

    fn note_next_visible(&mut self) {
        let playback = self.playback.as_ref().and_then(Playback::next_edge);
        let edge = playback.map_or(u64::MAX, |(at, _)| at.saturating_add(SYNC_CYCLES));
        self.next_visible = edge.min(self.next_change());
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

    /// Input levels as a reader at cycle `now` sees them. Pins in `bypass` skip the synchroniser; for a pin with edges of its own cycles
    /// that is exact only between them.
    #[inline]
    pub fn synced(&mut self, now: u64, bypass: u32) -> u32 {
        if now >= self.next_visible || bypass != 0 {
            self.pass_edges(now, bypass);
        }
        if now < self.settled_at {
            return self.on_their_way(now, bypass);
        }
        self.seen
    }

    /// The first cycle behind `now` at which a reader may see other levels than [`Pins::synced`] has just given, as far as nothing but what comes from outside
    /// changes them.
    #[inline]
    pub fn unchanged_until(&self, now: u64, bypass: u32) -> u64 {
        if bypass != 0 || now < self.settled_at {
            now + 1
        } else {
            self.next_visible
        }
    }

    /// Whether readers see the same level of `pin` from cycle `from` on until something outside changes it at a cycle that [`Pins::next_change`] names, or a
    /// register or a peripheral does.
    pub fn steady(&self, pin: u32, from: u64, bypass: u32) -> bool {
        let played = self.playback.as_ref().is_some_and(|p| p.pin == pin);
        !played && bypass >> pin & 1 == 0 && from >= self.settled_at
    }

    #[cold]
    fn on_their_way(&self, now: u64, bypass: u32) -> u32 {
        let at_once = bypass | self.edged;
        self.seen & at_once | self.sync.seen(now, self.seen) & !at_once
    }

    #[cold]
    fn pass_edges(&mut self, now: u64, bypass: u32) {
        let delay = |pin: u32| match bypass & (1 << pin) {
            0 => SYNC_CYCLES,
            _ => 0,
        };
        while let Some(&(at, pin, level)) = self.changes.front() {
            if at + delay(pin) > now {
                break;
            }
            self.changes.pop_front();
            self.pass_edge(pin, level);
        }
        while let Some(playback) = &mut self.playback {
            let pin = playback.pin;
            match playback.next_edge() {
                Some((at, level)) if at.saturating_add(delay(pin)) <= now => {
                    playback.pass_edge();
                    self.pass_edge(pin, level);
                }
                _ => break,
            }
        }
        self.note_next_visible();
    }

    fn pass_edge(&mut self, pin: u32, level: bool) {
        let bit = 1 << pin;
        if level != (self.external & bit != 0) {
            self.external ^= bit;
            if (self.oe | self.held_low) & bit == 0 {
                let before = self.chosen.irq.apply(self.seen);
                self.level = self.level & !bit | self.external & bit;
                self.seen = self.visible();
                let sensed = self.chosen.irq.apply(self.seen);
                if (before ^ sensed) & bit != 0 {
                    let event = if sensed & bit != 0 { 8 } else { 4 };
                    self.intr[pin as usize / 8] |= event << (4 * (pin % 8));
                }
            }
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
        let was = self.seen;
        let before = self.chosen.irq.apply(was);
        self.seen = self.visible();
        if self.seen != was {
            self.sync.change(self.now, was);
            self.settled_at = self.sync.settled_at();
        }
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

    /// From now on every edge of these pins is wanted at its cycle, as for a trace: signals that move by themselves (UART, PWM) are
    /// otherwise worked out only when they are read.
    pub fn watch(&mut self, mask: u32) {
        self.watch = mask;
    }

    /// Pins of which every edge is wanted: those of [`Pins::watch`], and those with an edge interrupt enabled.
    pub fn watched(&self) -> u32 {
        let mut mask = self.watch;
        for (n, bit) in (0..PADS).map(|n| (n, 1 << n)) {
            let enabled = self
                .inte
                .iter()
                .any(|e| e[n / 8] >> (4 * (n % 8)) & 0xf != 0);
            if enabled {
                mask |= bit;
            }
        }
        mask
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
