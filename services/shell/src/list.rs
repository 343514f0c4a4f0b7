//! Long replies, a few lines at a time, so that they wait for room and not for memory.
//!
//! | list | line | end |
//! |---|---|---|
//! | `AT+HELP` in RUN | `<command>:<help>` | `OK` |
//! | `AT+HELP` in CONFIGURATION | headings, `  AT+X=v [<help>]`, `  AT+X [<help>]` | – |
//! | `AT+SETTINGS?` in RUN | `<name>: <value>` | `OK` |
//! | `AT+SETTINGS?` in CONFIGURATION | `AT+X=v` | – |
//! | `AT+SETTINGS?DUMP` | `AT+X=v`, to be sent again in RUN | `OK` |
//! | `AT+3RD_PARTY_LICENSES` | `<crate>: <licence>` | `OK` |
//!
//! The lists of 003's CONFIGURATION end without a word, as its examples do.

use crate::command::MASK;
use crate::device::Device;
use crate::dialect::{Dialect, Out};
use crate::licenses::LICENSES;
use crate::shown::{Place, Shown};
use core::fmt;
use settings::choices::{Protocol, TriggerMode};
use settings::{ENTRIES, Entry, Field, Group, Port, Scope, Settings, What};

/// Which list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum List {
    Help,
    Settings,
    Dump,
    Licenses,
}

/// A list under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listing {
    list: List,
    next: usize,
}

impl Listing {
    pub(crate) const fn new(list: List) -> Self {
        Self { list, next: 0 }
    }

    /// Tells the next few lines, at most [`Listing::MAX_LINES`]; whether more follow.
    pub fn turn<D: Device>(&mut self, device: &D, place: Place, out: &mut dyn Out) -> bool {
        let index = self.next;
        self.next += 1;
        let dialect = place.dialect();
        let rows = match self.list {
            List::Licenses => LICENSES.lines().count(),
            List::Help | List::Settings | List::Dump => ENTRIES.len(),
        };
        if index >= rows {
            let silent = matches!(self.list, List::Help | List::Settings);
            if !(silent && dialect == Dialect::Aerobits) {
                out.line(format_args!("{}", dialect.ok()));
            }
            return false;
        }
        match (self.list, dialect) {
            (List::Licenses, _) => {
                let line = LICENSES.lines().nth(index).unwrap_or("");
                out.line(format_args!("{line}"));
            }
            (List::Help, Dialect::Adsbee) => help(&ENTRIES[index], out),
            (List::Help, Dialect::Aerobits) => grouped_help(index, device, place, out),
            (List::Settings, Dialect::Adsbee) => readable(&ENTRIES[index], device, place, out),
            (List::Settings, Dialect::Aerobits) => plain(&ENTRIES[index], device, place, out),
            (List::Dump, _) => dump(&ENTRIES[index], device, place, out),
        }
        true
    }

    /// Lines a turn.
    pub const MAX_LINES: usize = 4;
}

fn help(entry: &Entry, out: &mut dyn Out) {
    let Entry {
        name,
        help,
        arguments,
        ..
    } = entry;
    match arguments.as_bytes() {
        [] => out.line(format_args!("{name}:{help}")),
        [b'?' | b'=', ..] => out.line(format_args!("{name}:{help}: AT+{name}{arguments}")),
        _ => out.line(format_args!("{name}:{help}: AT+{name}={arguments}")),
    }
}

fn grouped_help<D: Device>(index: usize, device: &D, place: Place, out: &mut dyn Out) {
    let entry = &ENTRIES[index];
    if index == 0 {
        out.line(format_args!("SETTINGS:"));
    }
    if index == 0 || ENTRIES[index - 1].group != entry.group {
        out.line(format_args!("{}:", entry.group.name()));
    }
    let Entry { name, help, .. } = entry;
    if entry.group == Group::Commands {
        out.line(format_args!("  AT+{name} [{help}]"));
    } else {
        let value = shown(entry, device, place);
        out.line(format_args!("  AT+{name}={value} [{help}]"));
    }
}

fn shown<'a, D: Device>(entry: &'a Entry, device: &'a D, place: Place) -> Shown<'a, D> {
    Shown {
        entry,
        device,
        place,
        dialect: place.dialect(),
    }
}

pub(crate) fn plain<D: Device>(entry: &Entry, device: &D, place: Place, out: &mut dyn Out) {
    if entry.group != Group::Commands {
        let value = shown(entry, device, place);
        out.line(format_args!("AT+{}={value}", entry.name));
    }
}

pub(crate) fn readable<D: Device>(entry: &Entry, device: &D, place: Place, out: &mut dyn Out) {
    let at = |port| shown(entry, device, Place { port, ..place });
    let name = entry.name;
    match entry.what {
        What::Setting { secret: true, .. } => {
            out.line(format_args!("{name}: {}", at(place.port)));
        }
        What::Setting {
            scope: Scope::Port, ..
        } => {
            let (console, comms) = (at(Port::Console), at(Port::CommsUart));
            out.line(format_args!(
                "{name}: {console} on CONSOLE, {comms} on COMMS_UART"
            ));
        }
        What::Setting {
            scope: Scope::BaudRate,
            ..
        } => {
            let Settings {
                comms_baud,
                gnss_baud,
                ..
            } = device.settings();
            out.line(format_args!(
                "{name}: {comms_baud} on COMMS_UART, {gnss_baud} on GNSS_UART"
            ));
        }
        What::Setting {
            scope: Scope::TriggerLevel,
            ..
        } if device.settings().tl_mode == TriggerMode::Learn => {
            out.line(format_args!("{name}: {}, steered", at(place.port)));
        }
        What::Setting { .. } => out.line(format_args!("{name}: {}", at(place.port))),
        What::Value { .. } | What::Command { .. } => {}
    }
}

/// The arguments of a line that sets these fields.
struct Arguments<'a>(&'a Settings, Port, &'a [Field]);

impl fmt::Display for Arguments<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        crate::shown::list(f, self.0, self.1, Dialect::Adsbee, self.2)
    }
}

pub(crate) fn dump<D: Device>(entry: &Entry, device: &D, place: Place, out: &mut dyn Out) {
    let What::Setting {
        fields,
        scope,
        secret,
        ..
    } = entry.what
    else {
        return;
    };
    let settings = device.settings();
    let name = entry.name;
    if secret {
        return out.line(format_args!("AT+{name}={MASK}"));
    }
    match scope {
        Scope::Port => {
            for port in Port::ALL {
                dump_of_port(entry, fields, settings, port, out);
            }
        }
        Scope::BaudRate => {
            let Settings {
                comms_baud,
                gnss_baud,
                ..
            } = settings;
            out.line(format_args!("AT+{name}=COMMS_UART,{comms_baud}"));
            out.line(format_args!("AT+{name}=GNSS_UART,{gnss_baud}"));
        }
        Scope::TriggerLevel => {
            let levels = Arguments(settings, place.port, &[Field::TlLo, Field::TlHi]);
            out.line(format_args!("AT+{name}={levels}"));
            if settings.tl_mode == TriggerMode::Learn {
                out.line(format_args!("AT+{name}=LEARN"));
            }
        }
        Scope::SerialNumber if settings.serial.is_empty() => {
            out.line(format_args!("AT+{name}=DEFAULT"));
        }
        Scope::Device | Scope::Echoed | Scope::Position | Scope::SerialNumber => {
            // A view is told by what it is a view of.
            if fields.iter().all(|field| field.is_stored()) {
                let value = Shown {
                    entry,
                    device,
                    place,
                    dialect: Dialect::Adsbee,
                };
                out.line(format_args!("AT+{name}={value}"));
            }
        }
    }
}

/// `PROTOCOL` where one word says it; else it is cleared, and decoded and raw are told apart.
fn dump_of_port(
    entry: &Entry,
    fields: &[Field],
    settings: &Settings,
    port: Port,
    out: &mut dyn Out,
) {
    let mixed = settings.port(port).protocol() == Protocol::Mixed;
    let (name, iface) = (entry.name, port.name());
    match fields {
        [Field::Protocol] if mixed => out.line(format_args!("AT+{name}={iface},NONE")),
        [Field::Decoded | Field::Raw] if !mixed => {}
        [Field::GnssRaw] => {}
        _ => {
            let value = Arguments(settings, port, fields);
            out.line(format_args!("AT+{name}={iface},{value}"));
        }
    }
}
