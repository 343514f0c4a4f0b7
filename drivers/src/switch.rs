//! A supply that a pin switches: bias tee (low is on), ESP32 (high is on).

use embedded_hal::digital::OutputPin;

/// The level at which the supply is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    Low,
    High,
}

/// The switch.
pub struct Switch<P> {
    pin: P,
    on: On,
}

impl<P: OutputPin> Switch<P> {
    /// Takes the pin, which stands at off.
    pub fn new(pin: P, on: On) -> Self {
        Self { pin, on }
    }

    /// Switches.
    pub fn set(&mut self, on: bool) -> Result<(), P::Error> {
        let level = on == (self.on == On::High);
        self.pin.set_state(level.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;
    use embedded_hal::digital::{ErrorType, PinState};

    struct Pin(Option<bool>);

    impl ErrorType for Pin {
        type Error = Infallible;
    }

    impl OutputPin for Pin {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.set_state(PinState::Low)
        }
        fn set_high(&mut self) -> Result<(), Infallible> {
            self.set_state(PinState::High)
        }
        fn set_state(&mut self, state: PinState) -> Result<(), Infallible> {
            self.0 = Some(state == PinState::High);
            Ok(())
        }
    }

    #[test]
    fn on_is_the_level_that_the_part_takes_for_on() {
        for (on, asked, level) in [
            (On::High, true, true),
            (On::High, false, false),
            (On::Low, true, false),
            (On::Low, false, true),
        ] {
            let mut switch = Switch::new(Pin(None), on);
            assert_eq!(switch.set(asked), Ok(()));
            assert_eq!(switch.pin.0, Some(level), "{on:?} {asked}");
        }
    }
}
