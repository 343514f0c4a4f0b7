//! Faults from text: `FAULT[=VALUE][@WHEN]`, the tables of [`super`].

use std::str::FromStr;

use super::{Fault, Memory, Planned, When, Wire};
use crate::board::eeprom::Defect;

/// How long the supply stays away where nobody says, ms.
const OFF_MS: u64 = 500;
/// Share of an operation after which the power fails where nobody says.
const SHARE: f64 = 0.5;

/// Why a text names no fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParseError {
    #[error("there is no fault `{0}`")]
    Unknown(String),
    #[error("`{fault}` needs a value: {form}")]
    Value { fault: String, form: &'static str },
    #[error("`{0}` takes no value")]
    NoValue(String),
    #[error(
        "`@{0}` is no time: 2.5s, 300ms, cycle:N, flash:N, flash:N:SHARE, eeprom:N or eeprom:N:SHARE"
    )]
    When(String),
    #[error("only power-cut and brown-out can happen inside an operation, not `{0}`")]
    NotInside(String),
}

impl FromStr for Planned {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, ParseError> {
        let (what, when) = match text.split_once('@') {
            Some((what, when)) => (what, self::when(when)?),
            None => (text, When::NOW),
        };
        let (name, value) = match what.split_once('=') {
            Some((name, value)) => (name, Some(value)),
            None => (what, None),
        };
        let fault = fault(name, value)?;
        let inside = matches!(when, When::FlashOperation { .. } | When::EepromWrite { .. });
        if inside && !matches!(fault, Fault::PowerCut { .. } | Fault::BrownOut) {
            return Err(ParseError::NotInside(name.into()));
        }
        Ok(Planned { fault, when })
    }
}

fn fault(name: &str, value: Option<&str>) -> Result<Fault, ParseError> {
    let needs = |form| ParseError::Value {
        fault: name.into(),
        form,
    };
    if let Some(fault) = plain(name) {
        return match value {
            None => Ok(fault),
            Some(_) => Err(ParseError::NoValue(name.into())),
        };
    }
    Ok(match name {
        "power-cut" => Fault::PowerCut {
            off_ms: match value {
                None => OFF_MS,
                Some(ms) => ms.parse().map_err(|_| needs("milliseconds"))?,
            },
        },
        "flip" => value
            .and_then(flip)
            .ok_or_else(|| needs("MEMORY:ADDRESS.BIT, such as flash:15321.4"))?,
        "flips" => value
            .and_then(flips)
            .ok_or_else(|| needs("MEMORY:RATE, such as sram:2.5 (a second)"))?,
        "hang" => value
            .and_then(core)
            .map(|core| Fault::Hang { core })
            .ok_or_else(|| needs("a core, 0 or 1"))?,
        "starve-dma" => value
            .and_then(|us| us.parse().ok())
            .map(|us| Fault::StarveDma { us })
            .ok_or_else(|| needs("microseconds"))?,
        "stray" => value
            .and_then(stray)
            .ok_or_else(|| needs("CORE:ADDRESS, such as 0:10000000"))?,
        "eeprom-nack" => value
            .and_then(|n| n.parse().ok())
            .map(|n| Fault::Eeprom(Defect::NackAt(n)))
            .ok_or_else(|| needs("the number of the byte refused, 0 being the address"))?,
        "uart-noise" => value
            .and_then(noise)
            .ok_or_else(|| needs("comms:RATE or gnss:RATE, such as comms:0.001"))?,
        other => return Err(ParseError::Unknown(other.into())),
    })
}

/// Faults without a value.
fn plain(name: &str) -> Option<Fault> {
    Some(match name {
        "brown-out" => Fault::BrownOut,
        "sda-low" => Fault::HoldI2c {
            sda: true,
            scl: false,
        },
        "scl-low" => Fault::HoldI2c {
            sda: false,
            scl: true,
        },
        "i2c-free" => Fault::HoldI2c {
            sda: false,
            scl: false,
        },
        "eeprom-absent" => Fault::Eeprom(Defect::Absent),
        "eeprom-busy" => Fault::Eeprom(Defect::AlwaysBusy),
        "eeprom-good" => Fault::Eeprom(Defect::None),
        "crystal-dead" => Fault::CrystalDead,
        "no-pps" => Fault::Pps(false),
        "pps" => Fault::Pps(true),
        "no-fix" => Fault::Fix(false),
        "fix" => Fault::Fix(true),
        "no-nmea" => Fault::Nmea(false),
        "nmea" => Fault::Nmea(true),
        "usb-unplug" => Fault::UsbPlug(false),
        "usb-plug" => Fault::UsbPlug(true),
        "usb-stop-reading" => Fault::UsbRead(false),
        "usb-read" => Fault::UsbRead(true),
        "usb-no-open" => Fault::UsbNoOpen,
        _ => return None,
    })
}

fn memory(name: &str) -> Option<Memory> {
    Some(match name {
        "flash" => Memory::Flash,
        "eeprom" => Memory::Eeprom,
        "sram" => Memory::Sram,
        _ => return None,
    })
}

fn flip(value: &str) -> Option<Fault> {
    let (memory_name, place) = value.split_once(':')?;
    let (address, bit) = place.split_once('.')?;
    let bit = bit.parse().ok().filter(|bit| *bit < 8)?;
    let digits = address.strip_prefix("0x").unwrap_or(address);
    Some(Fault::Flip {
        memory: memory(memory_name)?,
        address: u32::from_str_radix(digits, 16).ok()?,
        bit,
    })
}

fn flips(value: &str) -> Option<Fault> {
    let (memory_name, rate) = value.split_once(':')?;
    Some(Fault::Flips {
        memory: memory(memory_name)?,
        per_second: number(rate)?,
    })
}

fn core(value: &str) -> Option<usize> {
    value.parse().ok().filter(|core| *core < 2)
}

fn stray(value: &str) -> Option<Fault> {
    let (which, address) = value.split_once(':')?;
    let digits = address.strip_prefix("0x").unwrap_or(address);
    Some(Fault::Stray {
        core: core(which)?,
        address: u32::from_str_radix(digits, 16).ok()?,
    })
}

fn noise(value: &str) -> Option<Fault> {
    let (port, rate) = value.split_once(':')?;
    Some(Fault::UartNoise {
        wire: match port {
            "comms" => Wire::Comms,
            "gnss" => Wire::Gnss,
            _ => return None,
        },
        rate: number(rate).filter(|rate| *rate <= 1.0)?,
    })
}

/// A finite number that is not negative.
fn number(text: &str) -> Option<f64> {
    text.parse()
        .ok()
        .filter(|n: &f64| n.is_finite() && *n >= 0.0)
}

fn when(text: &str) -> Result<When, ParseError> {
    let refused = || ParseError::When(text.into());
    let mut parts = text.split(':');
    let head = parts.next().unwrap_or_default();
    let rest: Vec<&str> = parts.collect();
    let time = |digits: &str, ps: f64| {
        let value = number(digits).ok_or_else(refused)?;
        Ok(When::Time((value * ps) as u128))
    };
    match (head, rest.as_slice()) {
        (head, []) if head.ends_with("ms") => time(&head[..head.len() - 2], 1e9),
        (head, []) if head.ends_with('s') => time(&head[..head.len() - 1], 1e12),
        ("cycle", [n]) => n.parse().map(When::Cycle).map_err(|_| refused()),
        ("flash" | "eeprom", [n] | [n, _]) => {
            let number_of = n.parse().ok().filter(|n| *n > 0).ok_or_else(refused)?;
            let share = match rest.get(1) {
                None => SHARE,
                Some(text) => number(text).filter(|s| *s <= 1.0).ok_or_else(refused)?,
            };
            Ok(match head {
                "flash" => When::FlashOperation {
                    number: number_of,
                    share,
                },
                _ => When::EepromWrite {
                    number: number_of,
                    share,
                },
            })
        }
        _ => Err(refused()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(fault: Fault, when: When) -> Result<Planned, ParseError> {
        Ok(Planned { fault, when })
    }

    #[test]
    fn every_form_of_the_tables_is_read() {
        let cut = Fault::PowerCut { off_ms: 500 };
        for (text, fault, when) in [
            ("power-cut@2.5s", cut, When::Time(2_500_000_000_000)),
            (
                "power-cut=7@cycle:123",
                Fault::PowerCut { off_ms: 7 },
                When::Cycle(123),
            ),
            (
                "power-cut@flash:3",
                cut,
                When::FlashOperation {
                    number: 3,
                    share: 0.5,
                },
            ),
            (
                "brown-out@eeprom:1:0.25",
                Fault::BrownOut,
                When::EepromWrite {
                    number: 1,
                    share: 0.25,
                },
            ),
            (
                "usb-unplug@300ms",
                Fault::UsbPlug(false),
                When::Time(300_000_000_000),
            ),
            ("crystal-dead", Fault::CrystalDead, When::NOW),
            (
                "flip=flash:0x15321.4",
                Fault::Flip {
                    memory: Memory::Flash,
                    address: 0x15321,
                    bit: 4,
                },
                When::NOW,
            ),
            (
                "flips=sram:2.5",
                Fault::Flips {
                    memory: Memory::Sram,
                    per_second: 2.5,
                },
                When::NOW,
            ),
            (
                "uart-noise=comms:0.001",
                Fault::UartNoise {
                    wire: Wire::Comms,
                    rate: 0.001,
                },
                When::NOW,
            ),
            ("hang=1", Fault::Hang { core: 1 }, When::NOW),
            ("starve-dma=80", Fault::StarveDma { us: 80 }, When::NOW),
            (
                "stray=0:20000001@3s",
                Fault::Stray {
                    core: 0,
                    address: 0x2000_0001,
                },
                When::Time(3_000_000_000_000),
            ),
            ("eeprom-nack=2", Fault::Eeprom(Defect::NackAt(2)), When::NOW),
        ] {
            assert_eq!(text.parse(), planned(fault, when), "{text}");
        }
    }

    #[test]
    fn what_is_no_fault_is_refused_with_the_reason() {
        for (text, reason) in [
            ("fire", "no fault `fire`"),
            ("flip", "needs a value"),
            ("flip=flash:12.8", "needs a value"),
            ("flip=rom:12.1", "needs a value"),
            ("power-cut=soon", "milliseconds"),
            ("hang=2", "needs a value"),
            ("stray=1", "needs a value"),
            ("starve-dma=long", "microseconds"),
            ("usb-unplug=1", "takes no value"),
            ("power-cut@noon", "is no time"),
            ("power-cut@flash:0", "is no time"),
            ("power-cut@flash:1:1.5", "is no time"),
            ("usb-unplug@flash:1", "inside an operation"),
            ("uart-noise=comms:2", "needs a value"),
            ("flips=sram:-1", "needs a value"),
        ] {
            let said = text.parse::<Planned>().unwrap_err().to_string();
            assert!(said.contains(reason), "{text}: {said}");
        }
    }

    /// The names in the module's table are the ones that are read.
    #[test]
    fn the_table_of_faults_is_complete() {
        let doc = include_str!("mod.rs");
        for line in doc.lines().filter(|l| l.starts_with("//! | `")) {
            let cell = line.split('|').nth(1).unwrap();
            for text in cell.split('`').filter(|t| !t.trim().is_empty()) {
                let example = text
                    .replace("=MS", "=5")
                    .replace("MEMORY:ADDRESS.BIT", "eeprom:1f.0")
                    .replace("MEMORY:RATE", "flash:1")
                    .replace("CORE:ADDRESS", "1:10000000")
                    .replace("=CORE", "=1")
                    .replace("PORT:RATE", "gnss:0.5")
                    .replace("=US", "=300")
                    .replace("=N", "=3")
                    .replace(":N", ":3")
                    .replace(":SHARE", ":0.1");
                let whole = match example.strip_prefix('@') {
                    Some(_) => format!("power-cut{example}"),
                    None => example,
                };
                assert!(whole.parse::<Planned>().is_ok(), "{whole}");
            }
        }
    }
}
