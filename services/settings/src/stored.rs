//! The set as bytes and back.
//!
//! ```text
//!   0      1                                   schema version, 1
//!   then   key  length  value                  one of each stored value, any order
//!          u8   u8      length bytes
//! ```
//! | key | value |
//! |---|---|
//! | the [`Field`]'s number; bit 7 for COMMS_UART's of a field that each port has | number: two's complement, little endian, as short as it holds |
//! | | text: its bytes |
//!
//! Loading judges each value alone: one that is unknown to its field, too long or cut falls back to the factory's and is counted, the others
//! hold. A key that this version does not know is kept as it is and stored again, for the newer version that wrote it; so is everything of a
//! newer schema whose items are laid out like this. Whether the bytes are whole is the store's matter, which guards them with a check sum.

use crate::field::{Field, ROWS};
use crate::kind::Value;
use crate::port::Port;
use crate::set::Settings;
use crate::text::Text;

/// Version of the layout.
pub const SCHEMA: u8 = 1;
/// Bytes of keys that are not known to this version, at most.
const MAX_UNKNOWN: usize = 192;
/// Bytes of a stored set, at most.
pub const MAX_BYTES: usize = 512;

/// Bit of a key: COMMS_UART's value.
const OF_COMMS_UART: u8 = 0x80;

/// What storage holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    /// The set.
    pub settings: Settings,
    /// Values that were no good and fell back to the factory's, or unknown ones that found no room.
    pub refused: u16,
    unknown: [u8; MAX_UNKNOWN],
    unknown_length: u16,
}

impl Stored {
    /// The factory's set.
    pub const FACTORY: Stored = Stored {
        settings: Settings::FACTORY,
        refused: 0,
        unknown: [0; MAX_UNKNOWN],
        unknown_length: 0,
    };

    /// Reads stored bytes; `None` when they are no set at all.
    pub fn load(bytes: &[u8]) -> Option<Stored> {
        let (&schema, mut rest) = bytes.split_first()?;
        if schema == 0 || schema == 0xff {
            return None;
        }
        let mut stored = Stored::FACTORY;
        while let [key, length, more @ ..] = rest {
            let Some((value, behind)) = more.split_at_checked(usize::from(*length)) else {
                stored.refused += 1;
                break;
            };
            rest = behind;
            stored.take(*key, value);
        }
        stored.settings.mend();
        Some(stored)
    }

    fn take(&mut self, key: u8, value: &[u8]) {
        let Some((field, port)) = field_of(key) else {
            return self.keep(key, value);
        };
        let is_text = matches!(field.get(&self.settings, port), Value::Text(_));
        let read = if is_text {
            let text = core::str::from_utf8(value).ok().and_then(Text::new);
            text.map(Value::Text)
        } else {
            number(value).map(Value::Number)
        };
        if !read.is_some_and(|value| field.put(&mut self.settings, port, value)) {
            self.refused += 1;
        }
    }

    fn keep(&mut self, key: u8, value: &[u8]) {
        let start = usize::from(self.unknown_length);
        let end = start + 2 + value.len();
        match self.unknown.get_mut(start..end) {
            Some([place_key, place_length, place @ ..]) => {
                *place_key = key;
                *place_length = value.len() as u8;
                place.copy_from_slice(value);
                self.unknown_length = end as u16;
            }
            _ => self.refused += 1,
        }
    }

    /// Writes what is to be stored; gives its length.
    pub fn save(&self, out: &mut [u8; MAX_BYTES]) -> usize {
        let mut writer = Writer { out, length: 0 };
        writer.put(&[SCHEMA]);
        for row in ROWS.iter().filter(|row| row.field.is_stored()) {
            let ports: &[Port] = if row.field.is_of_port() {
                &Port::ALL
            } else {
                &[Port::Console]
            };
            for &port in ports {
                let key = row.field as u8
                    | if port == Port::CommsUart {
                        OF_COMMS_UART
                    } else {
                        0
                    };
                writer.item(key, row.field.get(&self.settings, port));
            }
        }
        writer.put(&self.unknown[..usize::from(self.unknown_length)]);
        writer.length
    }
}

/// The field and port of a key.
fn field_of(key: u8) -> Option<(Field, Port)> {
    let row = ROWS
        .iter()
        .find(|row| row.field.is_stored() && row.field as u8 == key & !OF_COMMS_UART)?;
    match (key & OF_COMMS_UART != 0, row.field.is_of_port()) {
        (false, _) => Some((row.field, Port::Console)),
        (true, true) => Some((row.field, Port::CommsUart)),
        (true, false) => None,
    }
}

/// A number of 1 to 4 bytes.
fn number(bytes: &[u8]) -> Option<i32> {
    let last = *bytes.last()?;
    let mut whole = [if last & 0x80 != 0 { 0xff } else { 0 }; 4];
    whole.get_mut(..bytes.len())?.copy_from_slice(bytes);
    Some(i32::from_le_bytes(whole))
}

struct Writer<'a> {
    out: &'a mut [u8; MAX_BYTES],
    length: usize,
}

impl Writer<'_> {
    fn item(&mut self, key: u8, value: Value) {
        match value {
            Value::Text(text) => {
                let text = text.as_str().as_bytes();
                self.put(&[key, text.len() as u8]);
                self.put(text);
            }
            Value::Number(value) => {
                let bytes = value.to_le_bytes();
                let length = (1..4)
                    .find(|&length| number(&bytes[..length]) == Some(value))
                    .unwrap_or(4);
                self.put(&[key, length as u8]);
                self.put(&bytes[..length]);
            }
        }
    }

    /// All fits: see the test of the largest set.
    fn put(&mut self, bytes: &[u8]) {
        if let Some(place) = self.out.get_mut(self.length..self.length + bytes.len()) {
            place.copy_from_slice(bytes);
            self.length += bytes.len();
        }
    }
}

#[cfg(test)]
#[path = "stored_tests.rs"]
mod tests;
