//! One line answered: what is changed, what is told, what else follows.

use crate::command::{Command, Kind, MASK};
use crate::device::{Device, Report, Saving};
use crate::dialect::{Dialect, Out};
use crate::line::Input;
use crate::list::{List, Listing};
use crate::refusal::Refusal;
use crate::setting::changed;
use crate::shown::{Place, Shown};
use crate::state::{Event, State};
use settings::choices::TriggerMode;
use settings::{
    Action, Entry, Field, Forms, Info, Kind as ValueKind, Port, Scope, Settings, What, find,
};

/// What follows a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// It is answered.
    Done,
    /// It is answered by this list, a turn at a time.
    List(Listing),
    /// A save goes on, and what comes of it is answered in this dialect.
    Saving(Dialect),
    /// The state machine answers it, in this dialect.
    Event(Event, Dialect),
}

/// Answers a line.
pub fn answer<D: Device>(
    input: Input<'_>,
    place: Place,
    device: &mut D,
    out: &mut dyn Out,
) -> After {
    let line = match input {
        Input::Line(line) => Ok(line),
        Input::TooLong => Err(Refusal::LineTooLong),
    };
    if place.port == Port::CommsUart && place.state == State::Run {
        return beside_reports(line.unwrap_or(""));
    }
    let dialect = place.dialect();
    match line.and_then(|line| carry_out(line, place, device, out)) {
        Ok(after) => after,
        Err(refusal) => {
            dialect.tell(out, Err(refusal));
            After::Done
        }
    }
}

/// COMMS_UART in RUN: two commands are known, everything else is somebody's traffic.
fn beside_reports(line: &str) -> After {
    // Printable bytes of a binary protocol may stand before it.
    let event = match line.rfind("AT+").map(|at| &line[at..]) {
        Some("AT+CONFIG=1") => Event::ConfigFixed,
        Some("AT+CONFIG=2") => Event::ConfigAsSet,
        _ => return After::Done,
    };
    After::Event(event, Dialect::Aerobits)
}

fn carry_out<D: Device>(
    line: &str,
    place: Place,
    device: &mut D,
    out: &mut dyn Out,
) -> Result<After, Refusal> {
    let dialect = place.dialect();
    let command = Command::parse(line)?;
    if command.name.is_empty() {
        dialect.tell(out, Ok::<(), Refusal>(()));
        return Ok(After::Done);
    }
    let any_case = dialect == Dialect::Aerobits;
    let entry = find(command.name, any_case).ok_or(Refusal::UnknownCommand)?;
    match (entry.what, command.kind) {
        (What::Command { .. }, Kind::Describe) => return Err(Refusal::NoQuery),
        (_, Kind::Describe) => describe(entry, dialect, out),
        (What::Command { action, forms }, kind) => {
            allowed(action, forms, kind)?;
            return act(action, command, place, device, out);
        }
        (What::Value { info, writable }, kind) => {
            return value(entry, info, writable, kind, place, device, out);
        }
        (
            What::Setting {
                fields,
                scope,
                secret,
                ..
            },
            Kind::Set(text),
        ) => {
            let new = changed(device.settings(), scope, fields, text, place.port)?;
            device.apply(&new).map_err(Refusal::Device)?;
            if dialect == Dialect::Adsbee && !secret {
                echo(command.name, scope, device.settings(), out);
            }
            dialect.tell(out, Ok::<(), Refusal>(()));
        }
        (What::Setting { .. }, Kind::Query("")) => {
            query(command.name, entry, place, device, out)?;
        }
        (What::Setting { .. }, Kind::Query(_)) => return Err(Refusal::NoQuery),
        (What::Setting { .. }, Kind::Bare) => return Err(Refusal::NotBare),
    }
    Ok(After::Done)
}

/// What was set, told before `OK`.
fn echo(name: &str, scope: Scope, settings: &Settings, out: &mut dyn Out) {
    match scope {
        Scope::TriggerLevel if settings.tl_mode == TriggerMode::Learn => {
            out.line(format_args!("+{name}=LEARN"));
        }
        Scope::TriggerLevel => {
            let (lo, hi) = (settings.tl_lo_mv, settings.tl_hi_mv);
            out.line(format_args!("+{name}={lo},{hi}"));
        }
        Scope::Echoed => out.line(format_args!("+{name}={}", settings.rx_gain)),
        Scope::Device | Scope::Port | Scope::BaudRate | Scope::Position | Scope::SerialNumber => {}
    }
}

fn query<D: Device>(
    typed: &str,
    entry: &Entry,
    place: Place,
    device: &mut D,
    out: &mut dyn Out,
) -> Result<(), Refusal> {
    let What::Setting { scope, secret, .. } = entry.what else {
        return Ok(());
    };
    let dialect = place.dialect();
    let name = entry.name;
    if secret {
        out.line(format_args!("{}{name}={MASK}", dialect.prefix()));
        return Ok(());
    }
    if scope == Scope::Echoed {
        let read = device.rx_gain().map_err(Refusal::Device)?;
        let set = device.settings().rx_gain;
        match dialect {
            Dialect::Adsbee => out.line(format_args!("+{typed}={set}({read})")),
            Dialect::Aerobits => out.line(format_args!("AT+{name}={set}")),
        }
        return Ok(());
    }
    let shown = |port| Shown {
        entry,
        device: &*device,
        place: Place { port, ..place },
        dialect,
    };
    match (dialect, scope) {
        (Dialect::Adsbee, Scope::Port) => {
            for port in Port::ALL {
                out.line(format_args!("+{name}={},{}", port.name(), shown(port)));
            }
        }
        (Dialect::Adsbee, Scope::BaudRate) => {
            let rates = device.baud_rates();
            let (comms, gnss) = (rates.comms_uart, rates.gnss_uart);
            out.line(format_args!(
                "+{name}={comms}(COMMS_UART),{gnss}(GNSS_UART)"
            ));
        }
        (Dialect::Adsbee, Scope::TriggerLevel) => {
            out.line(format_args!("+{typed}={}", shown(place.port)));
        }
        _ => {
            let prefix = dialect.prefix();
            out.line(format_args!("{prefix}{name}={}", shown(place.port)));
        }
    }
    Ok(())
}

/// A value of the device; `CONFIG` and `LOCK` are what moves it between its states.
fn value<D: Device>(
    entry: &Entry,
    info: Info,
    writable: bool,
    kind: Kind<'_>,
    place: Place,
    device: &mut D,
    out: &mut dyn Out,
) -> Result<After, Refusal> {
    // These two are of the second family, in RUN too.
    let dialect = match info {
        Info::Config | Info::Lock => Dialect::Aerobits,
        _ => place.dialect(),
    };
    let event = match (kind, info) {
        (Kind::Query(""), _) => {
            let shown = Shown {
                entry,
                device: &*device,
                place,
                dialect,
            };
            out.line(format_args!("{}{}={shown}", dialect.prefix(), entry.name));
            return Ok(After::Done);
        }
        (Kind::Query(_) | Kind::Describe, _) => return Err(Refusal::NoQuery),
        (Kind::Bare, _) => return Err(Refusal::NotBare),
        (Kind::Set(_), _) if !writable => return Err(Refusal::NoSet),
        (Kind::Set("0"), Info::Config) => Event::ConfigEnd,
        (Kind::Set("1"), Info::Config) => Event::ConfigFixed,
        (Kind::Set("2"), Info::Config) => Event::ConfigAsSet,
        (Kind::Set("0"), Info::Lock) => Event::Unlock,
        (Kind::Set("1"), Info::Lock) => Event::Lock,
        (Kind::Set(_), Info::Config) => return Err(Refusal::Word("0 1 2")),
        (Kind::Set(_), _) => return Err(Refusal::Word("0 1")),
    };
    Ok(After::Event(event, dialect))
}

/// Whether a command is written in one of its forms.
fn allowed(action: Action, forms: Forms, kind: Kind<'_>) -> Result<(), Refusal> {
    match kind {
        Kind::Bare if !forms.bare => Err(Refusal::NotBare),
        Kind::Query(_) if !forms.query => Err(Refusal::NoQuery),
        Kind::Set(_) if !forms.set => Err(Refusal::NoSet),
        Kind::Query(word) if !word.is_empty() && action != Action::Settings => {
            Err(Refusal::NoQuery)
        }
        _ => Ok(()),
    }
}

fn act<D: Device>(
    action: Action,
    command: Command<'_>,
    place: Place,
    device: &mut D,
    out: &mut dyn Out,
) -> Result<After, Refusal> {
    let Command { name, kind } = command;
    let dialect = place.dialect();
    let done = match action {
        Action::Help => return Ok(After::List(Listing::new(List::Help))),
        Action::Licenses => return Ok(After::List(Listing::new(List::Licenses))),
        Action::Reboot => return Ok(After::Event(Event::Reboot, dialect)),
        Action::RebootBootloader => return Ok(After::Event(Event::RebootBootloader, dialect)),
        Action::BootUsbUf2 => return usb_drive(kind, device, dialect, out),
        Action::Settings => return settings(kind, device, dialect, out),
        Action::SettingsDefault => device.apply(&Settings::FACTORY),
        Action::DeviceInfo => {
            device_info(device, out);
            Ok(())
        }
        Action::Stats => device.tell(Report::Stats, dialect.prefix(), out),
        Action::Gnss => device.tell(Report::Gnss, dialect.prefix(), out),
        Action::Info => device.tell(Report::Info, "", out),
        Action::Test if dialect == Dialect::Aerobits => {
            // The first failure alone.
            device.tell(Report::Test, "", &mut |_: core::fmt::Arguments<'_>| {})
        }
        Action::Test => device.tell(Report::Test, "", out),
        Action::TlRead => {
            let (low, high) = device.trigger_levels().map_err(Refusal::Device)?;
            let prefix = dialect.prefix();
            // As TL_SET: under the name as typed, in RUN.
            let name = match dialect {
                Dialect::Adsbee => name,
                Dialect::Aerobits => "TL_READ",
            };
            match low {
                Some(low) => out.line(format_args!("{prefix}{name}={low},{high}")),
                None => out.line(format_args!("{prefix}{name}={high}")),
            }
            return Ok(After::Done);
        }
    };
    match done {
        // What is asked with `?` ends with its last line.
        Ok(()) if matches!(action, Action::Stats | Action::Gnss) => {}
        done => dialect.tell(out, done.map_err(Refusal::Device)),
    }
    Ok(After::Done)
}

/// The drive takes unsigned images: it is entered only when that was allowed since the start.
fn usb_drive<D: Device>(
    kind: Kind<'_>,
    device: &mut D,
    dialect: Dialect,
    out: &mut dyn Out,
) -> Result<After, Refusal> {
    match kind {
        Kind::Bare if *device.usb_drive_allowed() => {
            return Ok(After::Event(Event::BootUsb, dialect));
        }
        Kind::Bare => return Err(Refusal::Device("not enabled, AT+BOOT_USB_UF2=1 does that")),
        Kind::Set("0") => *device.usb_drive_allowed() = false,
        Kind::Set("1") => *device.usb_drive_allowed() = true,
        Kind::Set(_) => return Err(Refusal::Word("0 1")),
        Kind::Query(_) | Kind::Describe => {
            let allowed = u8::from(*device.usb_drive_allowed());
            out.line(format_args!("{}BOOT_USB_UF2={allowed}", dialect.prefix()));
            return Ok(After::Done);
        }
    }
    dialect.tell(out, Ok::<(), Refusal>(()));
    Ok(After::Done)
}

fn settings<D: Device>(
    kind: Kind<'_>,
    device: &mut D,
    dialect: Dialect,
    out: &mut dyn Out,
) -> Result<After, Refusal> {
    let done = match kind {
        Kind::Query("") => return Ok(After::List(Listing::new(List::Settings))),
        Kind::Query(word) if word.eq_ignore_ascii_case("DUMP") => {
            return Ok(After::List(Listing::new(List::Dump)));
        }
        Kind::Set(word) if word.eq_ignore_ascii_case("SAVE") => match device.save() {
            Ok(Saving::UnderWay) => return Ok(After::Saving(dialect)),
            done => done.map(|_| ()),
        },
        Kind::Set(word) if word.eq_ignore_ascii_case("LOAD") => device.load(),
        Kind::Set(word) if word.eq_ignore_ascii_case("RESET") => device.apply(&Settings::FACTORY),
        Kind::Set(_) => return Err(Refusal::Word("SAVE LOAD RESET")),
        _ => return Err(Refusal::NoQuery),
    };
    dialect.tell(out, done.map_err(Refusal::Device));
    Ok(After::Done)
}

/// The lines that the ADSBee's own tools look for.
fn device_info<D: Device>(device: &D, out: &mut dyn Out) {
    let identity = device.identity();
    out.line(format_args!("Part Code: {}", identity.serial));
    out.line(format_args!(
        "RP2040 Firmware Version: {}",
        identity.version
    ));
    out.line(format_args!("Device: {}", identity.device));
}

/// The eight lines of `=?`.
fn describe(entry: &Entry, dialect: Dialect, out: &mut dyn Out) {
    let (type_name, (min, max), restart, writable) = match entry.what {
        What::Setting {
            fields,
            scope,
            restart,
            ..
        } => {
            let kind = fields
                .first()
                .copied()
                .map_or(ValueKind::Integer { min: 0, max: 0 }, Field::kind);
            let range = match scope {
                Scope::BaudRate => (0, 3),
                _ => kind.range(),
            };
            (kind.type_name(), range, restart, true)
        }
        What::Value { info, writable } => {
            let (type_name, range) = described(info);
            (type_name, range, false, writable)
        }
        What::Command { .. } => return,
    };
    let access = if writable { "Read Write" } else { "Read" };
    out.line(format_args!("Setting: {}", entry.name));
    out.line(format_args!("Description: {}", entry.help));
    out.line(format_args!("Access: {access}"));
    out.line(format_args!("Type: {type_name}"));
    out.line(format_args!("Range (min.): {min}"));
    out.line(format_args!("Range (max.): {max}"));
    out.line(format_args!(
        "Preserved: {}",
        u8::from(entry.is_preserved())
    ));
    out.line(format_args!("Requires restart: {}", u8::from(restart)));
    if dialect == Dialect::Adsbee {
        out.line(format_args!("{}", dialect.ok()));
    }
}

/// Type and range of a value of the device; of a text, its lengths.
const fn described(info: Info) -> (&'static str, (i32, i32)) {
    match info {
        Info::Boot | Info::Lock => ("Integer decimal", (0, 1)),
        Info::Config => ("Integer decimal", (0, 2)),
        Info::Uptime => ("Integer decimal", (0, i32::MAX)),
        Info::Device => ("String", (1, 16)),
        Info::FirmwareVersion => ("String", (1, 32)),
    }
}

#[cfg(test)]
#[path = "answer_tests.rs"]
mod tests;
