//! What a Beast client sends back: `1A 31 <letter>`, options of a real Beast. They are swallowed on every port in RUN, for a client that
//! opens a port sends them before it knows what it will hear; the rest is for the shell.
//!
//! | letter | means |
//! |---|---|
//! | `J`, `j` | Mode A/C replies on, off |
//! | others | formats, filters and checks that this device does not offer: no effect |
//!
//! Source: the Beast's option letters as dump1090 and readsb send them.

const ESCAPE: u8 = 0x1A;
const OPTION: u8 = b'1';

/// What came of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fed {
    /// It belongs to no option.
    Text(u8),
    /// It is part of an option.
    Swallowed,
    /// It ends an option that turns Mode A/C on or off.
    ModeAc(bool),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum State {
    #[default]
    Text,
    Escape,
    Letter,
}

/// Takes options out of a port's input.
#[derive(Clone, Copy, Debug, Default)]
pub struct BeastInput {
    state: State,
}

impl BeastInput {
    /// At the start of the input.
    pub const fn new() -> Self {
        BeastInput { state: State::Text }
    }

    /// Takes a byte.
    pub fn feed(&mut self, byte: u8) -> Fed {
        let (state, fed) = match (self.state, byte) {
            (State::Text | State::Escape, ESCAPE) => (State::Escape, Fed::Swallowed),
            (State::Text, byte) => (State::Text, Fed::Text(byte)),
            (State::Escape, OPTION) => (State::Letter, Fed::Swallowed),
            // Not an option: the escape alone is dropped, which no command holds.
            (State::Escape, byte) => (State::Text, Fed::Text(byte)),
            (State::Letter, b'J') => (State::Text, Fed::ModeAc(true)),
            (State::Letter, b'j') => (State::Text, Fed::ModeAc(false)),
            (State::Letter, _) => (State::Text, Fed::Swallowed),
        };
        self.state = state;
        fed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn fed(bytes: &[u8]) -> (Vec<u8>, Vec<bool>) {
        let (mut text, mut mode_ac) = (Vec::new(), Vec::new());
        let mut input = BeastInput::new();
        for &byte in bytes {
            match input.feed(byte) {
                Fed::Text(byte) => text.push(byte),
                Fed::ModeAc(on) => mode_ac.push(on),
                Fed::Swallowed => {}
            }
        }
        (text, mode_ac)
    }

    #[test]
    fn options_are_swallowed_and_mode_ac_is_heard() {
        let (text, mode_ac) = fed(b"\x1a1C\x1a1d\x1a1JAT+CONFIG=1\r\n\x1a1j");
        assert_eq!(text, b"AT+CONFIG=1\r\n");
        assert_eq!(mode_ac, [true, false]);
    }

    #[test]
    fn a_broken_option_costs_no_text() {
        assert_eq!(fed(b"\x1aAT\x1a\x1a1xO").0, b"ATO");
    }
}
