//! The status LED: lit for one beat after a frame, so that a glance tells traffic from silence.

use embedded_hal::digital::OutputPin;

/// The LED; high is on.
pub struct Led<P> {
    pin: P,
    lit: bool,
    heard: bool,
}

impl<P: OutputPin> Led<P> {
    /// Takes the pin, LED off.
    pub fn new(pin: P) -> Self {
        Self {
            pin,
            lit: false,
            heard: false,
        }
    }

    /// A frame was accepted.
    pub fn frame(&mut self) {
        self.heard = true;
    }

    /// Called at a steady beat (20 a second): shows what was heard since the last one.
    pub fn beat(&mut self) {
        if self.heard != self.lit {
            // A pin that cannot be set leaves the LED as it is; nothing depends on it.
            let done = if self.heard {
                self.pin.set_high()
            } else {
                self.pin.set_low()
            };
            if done.is_ok() {
                self.lit = self.heard;
            }
        }
        self.heard = false;
    }
}
