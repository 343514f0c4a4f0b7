//! A setting's arguments, judged and put into a copy of the set.

use crate::command::arguments;
use crate::refusal::Refusal;
use settings::choices::{RxSource, TriggerMode};
use settings::{Field, INDEXED_BAUDS, Port, Scope, Settings, Text, Value};

/// The set as the line wants it; nothing but what the line names differs.
pub(crate) fn changed(
    settings: &Settings,
    scope: Scope,
    fields: &[Field],
    text: &str,
    port: Port,
) -> Result<Settings, Refusal> {
    let mut changed = *settings;
    match scope {
        Scope::Device | Scope::Echoed => put_all(&mut changed, fields, text)?,
        Scope::Port => put_of_port(&mut changed, fields, text, port)?,
        Scope::BaudRate => put_baud(&mut changed, text)?,
        Scope::TriggerLevel => put_levels(&mut changed, text)?,
        Scope::Position => put_position(&mut changed, text)?,
        Scope::SerialNumber => put_serial(&mut changed, text)?,
    }
    changed.check().map_err(Refusal::Conflict)?;
    Ok(changed)
}

fn put(settings: &mut Settings, field: Field, port: Port, text: &str) -> Result<(), Refusal> {
    let kind = field.kind();
    let value = kind.parse(text)?;
    if field.put(settings, port, value) {
        Ok(())
    } else {
        // In its range and still none: a name that is read only.
        Err(kind
            .parse("")
            .map_or_else(Refusal::from, |_| Refusal::NoSet))
    }
}

fn put_all(settings: &mut Settings, fields: &[Field], text: &str) -> Result<(), Refusal> {
    let given = arguments(text, fields.len())?;
    for (field, argument) in fields.iter().zip(given) {
        if let Some(argument) = argument {
            put(settings, *field, Port::Console, argument)?;
        }
    }
    Ok(())
}

/// `v` on the port it arrived on, or `<iface>,v`.
fn put_of_port(
    settings: &mut Settings,
    fields: &[Field],
    text: &str,
    port: Port,
) -> Result<(), Refusal> {
    let (port, argument) = match arguments(text, 2)? {
        [only, None, ..] if !text.contains(',') => (Some(port), only),
        [name, argument, ..] => {
            let port = |name| Port::from_name(name).ok_or(Refusal::UnknownInterface);
            (name.map(port).transpose()?, argument)
        }
    };
    let Some(argument) = argument else {
        return Ok(());
    };
    for field in fields {
        // Without an interface nothing changes; the value is judged all the same.
        let mut unused = *settings;
        let target = if port.is_some() {
            &mut *settings
        } else {
            &mut unused
        };
        put(target, *field, port.unwrap_or(Port::Console), argument)?;
    }
    Ok(())
}

/// An index or a rate of COMMS_UART, or `<iface>,<rate>`.
fn put_baud(settings: &mut Settings, text: &str) -> Result<(), Refusal> {
    if !text.contains(',') {
        let index = text.parse().ok().filter(|_| text.len() == 1);
        return match index.and_then(|index: usize| INDEXED_BAUDS.get(index)) {
            Some(&baud) => {
                settings.comms_baud = baud;
                Ok(())
            }
            None => put(settings, Field::CommsBaud, Port::Console, text),
        };
    }
    let [name, baud, ..] = arguments(text, 2)?;
    let field = match name {
        None => None,
        Some(name) if is_one_of(name, &["COMMS_UART", "COMMS"]) => Some(Field::CommsBaud),
        Some(name) if is_one_of(name, &["GNSS_UART", "GNSS"]) => Some(Field::GnssBaud),
        Some(_) => return Err(Refusal::UnknownInterface),
    };
    match (field, baud) {
        (Some(field), Some(baud)) => put(settings, field, Port::Console, baud),
        (None, Some(baud)) => put(&mut settings.clone(), Field::CommsBaud, Port::Console, baud),
        (_, None) => Ok(()),
    }
}

fn is_one_of(name: &str, names: &[&str]) -> bool {
    names.iter().any(|own| own.eq_ignore_ascii_case(name))
}

/// `<lo>,<hi>`, which ends steering, or `LEARN`.
fn put_levels(settings: &mut Settings, text: &str) -> Result<(), Refusal> {
    if text.eq_ignore_ascii_case(TriggerMode::Learn.name()) {
        settings.tl_mode = TriggerMode::Learn;
        return Ok(());
    }
    put_all(settings, &[Field::TlLo, Field::TlHi], text)?;
    if text.bytes().any(|byte| byte != b',') {
        settings.tl_mode = TriggerMode::Set;
    }
    Ok(())
}

/// `NONE`, `FIXED,<lat>,<lon>,<height>`, `GNSS`, `LOWEST`, `ICAO,<address>`.
fn put_position(settings: &mut Settings, text: &str) -> Result<(), Refusal> {
    let [source, ..] = arguments(text, 4)?;
    if let Some(source) = source {
        put(settings, Field::RxSource, Port::Console, source)?;
    }
    let fields: &[Field] = match settings.rx_source {
        RxSource::None | RxSource::Gnss | RxSource::Lowest => &[Field::RxSource],
        RxSource::Fixed => &[Field::RxSource, Field::RxLat, Field::RxLon, Field::RxHeight],
        RxSource::Icao => &[Field::RxSource, Field::RxIcao],
    };
    put_all(settings, fields, text)
}

/// A text, or `DEFAULT`: none.
fn put_serial(settings: &mut Settings, text: &str) -> Result<(), Refusal> {
    if text.eq_ignore_ascii_case("DEFAULT") {
        settings.serial = Text::EMPTY;
        return Ok(());
    }
    let [serial, ..] = arguments(text, 1)?;
    match serial.map(|serial| Field::Serial.kind().parse(serial)) {
        Some(Ok(Value::Text(serial))) => settings.serial = serial,
        Some(Ok(Value::Number(_))) | None => {}
        Some(Err(refused)) => return Err(refused.into()),
    }
    Ok(())
}
