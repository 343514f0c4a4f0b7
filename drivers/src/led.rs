//! The status LED: lit for one beat after a frame, so that a glance tells traffic from silence; slow blinks in CONFIGURATION.
//!
//! | shows | LED |
//! |---|---|
//! | frames | lit for the beat after one |
//! | slow | [`SLOW_BEATS`] beats on, as many off |
//! | dark | off |
//!
//! (Fast blinks are the bootloader's.) Among the frames it shows the clock's state once a second: one short flash when locked to PPS, two in holdover, three with
//! NMEA alone, none without a GNSS receiver.
//!
//! ```text
//!   beat      0   1   2   3   4   5   6   7   8 … 19     20 a second
//!   locked    ▆
//!   holdover  ▆               ▆
//!   coarse    ▆               ▆               ▆
//! ```

use embedded_hal::digital::OutputPin;

/// Beats of half a slow blink: half a second at 20 beats a second.
pub const SLOW_BEATS: u8 = 10;

/// What it shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Frames.
    Frames,
    /// Slow blinks.
    Slow,
    /// Nothing.
    Dark,
}

/// The LED; high is on.
pub struct Led<P> {
    pin: P,
    lit: bool,
    heard: bool,
    beats: u8,
    /// Flashes that are due in the second under way.
    flashes: u8,
}

/// Beats from a flash to the next.
const APART: u8 = 4;

impl<P: OutputPin> Led<P> {
    /// Takes the pin, LED off.
    pub fn new(pin: P) -> Self {
        Self {
            pin,
            lit: false,
            heard: false,
            beats: 0,
            flashes: 0,
        }
    }

    /// A frame was accepted.
    pub fn frame(&mut self) {
        self.heard = true;
    }

    fn is_flash(&self) -> bool {
        self.beats.is_multiple_of(APART) && self.beats / APART < self.flashes
    }

    /// So many flashes a second from the next second on.
    pub fn mark(&mut self, flashes: u8) {
        if self.beats == 0 {
            self.flashes = flashes;
        }
    }

    /// Called at a steady beat (20 a second).
    pub fn beat(&mut self, shows: Shows) {
        self.beats = (self.beats + 1) % (2 * SLOW_BEATS);
        let light = match shows {
            Shows::Frames => self.heard || self.is_flash(),
            Shows::Slow => self.beats < SLOW_BEATS,
            Shows::Dark => false,
        };
        if light != self.lit {
            // A pin that cannot be set leaves the LED as it is; nothing depends on it.
            let done = if light {
                self.pin.set_high()
            } else {
                self.pin.set_low()
            };
            if done.is_ok() {
                self.lit = light;
            }
        }
        self.heard = false;
    }
}
