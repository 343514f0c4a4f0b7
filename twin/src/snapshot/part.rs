//! What hangs on the chip by a trait, as plain values: the twin's own parts. A device of somebody else cannot be kept in a file, and says so.

use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::board::eeprom::Eeprom;
use crate::board::gnss::Gnss;
use crate::board::pin_serial::PinSerial;
use crate::board::potentiometer::Potentiometer;
use crate::chip::adc::{AnalogInput, Steady};
use crate::chip::i2c::I2cTarget;
use crate::chip::outside::Outside;
use crate::front_end::trigger_level::TriggerLevel;

/// A part and its state.
#[derive(Serialize, Deserialize)]
pub enum Part {
    Eeprom(Eeprom),
    Potentiometer(Potentiometer),
    PinSerial(PinSerial),
    Gnss(Box<Gnss>),
    Steady(Steady),
    TriggerLevel(TriggerLevel),
}

/// Writes and reads a boxed trait object by its part.
macro_rules! by_part {
    ($object:ty, $what:literal, $($part:ident => $make:expr),+) => {
        impl Serialize for Box<$object> {
            fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                let part = self.part().ok_or_else(|| {
                    S::Error::custom(concat!($what, " that is not one of the twin's parts is attached"))
                })?;
                part.serialize(to)
            }
        }

        impl<'de> Deserialize<'de> for Box<$object> {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                match Part::deserialize(from)? {
                    $(Part::$part(part) => Ok($make(part)),)+
                    _ => Err(D::Error::custom(concat!("a part that is no ", $what))),
                }
            }
        }
    };
}

by_part!(dyn I2cTarget, "I2C target", Eeprom => Box::new, Potentiometer => Box::new);
by_part!(dyn Outside, "device outside", PinSerial => Box::new, Gnss => |gnss| gnss);
by_part!(dyn AnalogInput, "analog input", Steady => Box::new, TriggerLevel => Box::new);
