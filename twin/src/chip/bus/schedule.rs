//! Who acts next: each peripheral names the cycle of its next event, and the bus asks again only after something changed.
//!
//! An idle peripheral names no cycle and costs nothing. PIO, DMA, USB host and surroundings keep their own cycles, which change with every
//! word they move; all others are in the table here.

use super::{Bus, ResetCause};
use crate::chip::cpu::ppb::SYSTICK_PENDING;
use serde::{Deserialize, Serialize};

/// Peripherals with deadlines, in the order in which those due at the same cycle act.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Actor {
    Clocks,
    Timer,
    Uart(usize),
    I2c(usize),
    Spi(usize),
    Adc,
    SysTick(usize),
    Pwm,
    Watchdog,
}

const ACTORS: [Actor; 13] = [
    Actor::Clocks,
    Actor::Timer,
    Actor::Uart(0),
    Actor::Uart(1),
    Actor::I2c(0),
    Actor::I2c(1),
    Actor::Spi(0),
    Actor::Spi(1),
    Actor::Adc,
    Actor::SysTick(0),
    Actor::SysTick(1),
    Actor::Pwm,
    Actor::Watchdog,
];

/// The cycles they named.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Deadlines {
    at: [u64; ACTORS.len()],
    earliest: u64,
    known: bool,
}

impl Deadlines {
    /// Any of them may have changed.
    pub(super) fn forget(&mut self) {
        self.known = false;
    }
}

impl Bus {
    fn deadline(&self, actor: Actor) -> u64 {
        match actor {
            Actor::Clocks => self.clocks.next_event(),
            Actor::Timer => self.timer.next_event(),
            Actor::Uart(n) => self.uart[n].next_event(),
            Actor::I2c(n) => self.i2c[n].next_event(),
            Actor::Spi(n) => self.spi[n].next_event(),
            Actor::Adc => self.adc.next_event(),
            Actor::SysTick(core) => self.systick[core].next_event(),
            Actor::Pwm => self.pwm.next_event(self.paced_by_pwm()),
            Actor::Watchdog => self.watchdog.next_event(),
        }
    }

    fn act(&mut self, actor: Actor) {
        let now = self.now;
        match actor {
            Actor::Clocks => {
                self.clocks.advance(now);
                self.clocks_changed();
            }
            Actor::Timer => self.timer.advance(now),
            Actor::Uart(n) => {
                let rts_n = self.uart[n].rts_n();
                self.uart[n].advance(now);
                if !self.uart[n].outside_hears.is_empty() {
                    self.tell_outside(n);
                }
                if self.uart[n].watched || self.uart[n].rts_n() != rts_n {
                    self.resolve_pins();
                }
            }
            Actor::I2c(n) => {
                self.i2c[n].advance(now);
                self.resolve_pins();
            }
            Actor::Spi(n) => {
                let time_ps = self.true_ps();
                self.spi[n].advance(now, time_ps);
                self.resolve_pins();
            }
            Actor::Adc => self.advance_adc(),
            Actor::SysTick(core) => {
                if self.systick[core].advance(now) {
                    self.ppb[core].icsr |= SYSTICK_PENDING;
                }
            }
            Actor::Pwm => {
                self.pwm.catch_up(now);
                if self.pwm.watched != 0 {
                    self.resolve_pins();
                }
            }
            Actor::Watchdog => {
                if self.watchdog.bites(now) && self.reset_request.is_none() {
                    self.reset_request = Some(ResetCause::WatchdogTimer);
                }
            }
        }
    }

    /// PWM slices whose wrap paces a DMA channel (DREQ 24 to 31).
    fn paced_by_pwm(&self) -> u32 {
        self.dma
            .channels
            .iter()
            .filter(|c| c.enabled() && (24..32).contains(&c.dreq()))
            .fold(0, |mask, c| mask | 1 << (c.dreq() - 24))
    }

    /// Cycle of the next event of any peripheral but PIO.
    pub(super) fn next_event(&mut self) -> u64 {
        if !self.deadlines.known {
            for (n, actor) in ACTORS.into_iter().enumerate() {
                self.deadlines.at[n] = self.deadline(actor);
            }
            self.deadlines.earliest = self.deadlines.at.into_iter().min().unwrap_or(u64::MAX);
            self.deadlines.known = true;
        }
        self.deadlines
            .earliest
            .min(self.usb_host.next_event())
            .min(self.surroundings.next)
            .min(self.pins.next_change())
            .min(self.dma_at)
    }

    /// Everything due at `now`, then the interrupt lines.
    pub(super) fn fire(&mut self) {
        let now = self.now;
        if self.surroundings.next <= now {
            self.run_surroundings();
            self.deadlines.forget();
        }
        let changes = self.pins.next_change() <= now;
        if changes {
            self.pins.synced(now, 0);
        }
        // Asked every time: a state machine that samples in this very cycle has taken the change already.
        for pio in &mut self.pio {
            pio.unpark_moved(now, &mut self.pins);
        }
        if changes {
            self.resolve_pins();
        }
        if self.deadlines.known && self.deadlines.earliest <= now {
            for (n, actor) in ACTORS.into_iter().enumerate() {
                // One that acts may move the others: then all are asked again.
                if self.deadlines.at[n] <= now {
                    self.act(actor);
                    self.deadlines.at[n] = self.deadline(actor);
                }
            }
            self.deadlines.earliest = self.deadlines.at.into_iter().min().unwrap_or(u64::MAX);
        }
        if self.usb_host.next_event() <= now {
            let per_ms = self.sys_hz / 1000;
            self.usb_host.advance(&mut self.usb, now, per_ms);
        }
        if self.dma.busy != 0 {
            self.move_data();
        } else {
            self.dma_at = u64::MAX;
        }
        self.lines_dirty = true;
        self.update_lines();
    }
}
