//! Replies that no example prints, and what `?DUMP` is for.

use super::*;
use crate::list;
use crate::model::Model;
use crate::shown::Shown;
use settings::{Group, ROWS, Value};
use std::string::{String, ToString};
use std::vec::Vec;

fn place(port: Port, state: State) -> Place {
    Place { port, state }
}

const CONFIGURATION: State = State::Configuration {
    as_set: false,
    locked: true,
};

fn told(device: &mut Model, place: Place, line: &str) -> Vec<String> {
    let mut said = Vec::new();
    let mut out = |text: core::fmt::Arguments<'_>| said.push(text.to_string());
    if let After::List(mut listing) = answer(Input::Line(line), place, device, &mut out) {
        while listing.turn(device, place, &mut out) {}
    }
    said
}

#[test]
fn a_dump_brings_the_factorys_set_to_any_other() {
    let run = place(Port::Console, State::Run);
    for row in ROWS.iter().filter(|row| row.field.is_stored()) {
        let values: Vec<Value> = match row.kind {
            ValueKind::Choice(choices) => {
                let codes = choices.iter().map(|choice| i32::from(choice.code));
                codes.map(Value::Number).collect()
            }
            ValueKind::Text { .. } => Vec::from([row.kind.parse("23-0000001").unwrap()]),
            kind => [kind.range().0, kind.range().1].map(Value::Number).into(),
        };
        for value in values {
            let mut device = Model {
                has_gain: true,
                ..Model::default()
            };
            // Good neighbours for a level at its end, and a position that shows its place.
            device.settings.tl_hi_mv = 3300;
            device.settings.rx_source = match row.field {
                Field::RxIcao => settings::choices::RxSource::Icao,
                _ => settings::choices::RxSource::Fixed,
            };
            assert!(row.field.put(&mut device.settings, Port::CommsUart, value));
            if device.settings.check().is_err() {
                continue;
            }
            let mut other = Model {
                has_gain: true,
                ..Model::default()
            };
            // Whatever it had before.
            other.settings.comms_uart.raw = settings::choices::Raw::None;
            let dump = told(&mut device, run, "AT+SETTINGS?DUMP");
            assert_eq!(dump.last().map(String::as_str), Some("OK"));
            for line in &dump[..dump.len() - 1] {
                let said = told(&mut other, run, line);
                assert!(said.last().is_some_and(|l| l == "OK"), "{line}: {said:?}");
            }
            let mut wanted = device.settings;
            if wanted.rx_source != settings::choices::RxSource::Fixed {
                // What the source does not need is not told.
                (wanted.rx_lat_e7, wanted.rx_lon_e7, wanted.rx_height_m) = (0, 0, 0);
            }
            if wanted.rx_source != settings::choices::RxSource::Icao {
                wanted.rx_icao = 0;
            }
            assert_eq!(other.settings, wanted, "{row:?} {value:?}");
        }
    }
}

#[test]
fn a_secret_is_never_told_in_any_list_whatever_its_scope() {
    let mut device = Model {
        has_gain: true,
        ..Model::default()
    };
    device.settings.serial = settings::Text::new("open sesame").unwrap();
    for scope in [
        Scope::Device,
        Scope::Port,
        Scope::BaudRate,
        Scope::TriggerLevel,
        Scope::Echoed,
        Scope::Position,
        Scope::SerialNumber,
    ] {
        let entry = Entry {
            name: "PASSWORD",
            aliases: &[],
            group: Group::System,
            arguments: "",
            help: "",
            what: What::Setting {
                fields: &[Field::Serial],
                scope,
                restart: false,
                secret: true,
            },
        };
        for state in [State::Run, CONFIGURATION] {
            let place = place(Port::Console, state);
            let shown = Shown {
                entry: &entry,
                device: &device,
                place,
                dialect: place.dialect(),
            };
            // Headings of AT+HELP in CONFIGURATION hold it like this.
            assert_eq!(shown.to_string(), "********");
            let mut said = Vec::new();
            let mut out = |text: core::fmt::Arguments<'_>| said.push(text.to_string());
            query("PASSWORD", &entry, place, &mut device, &mut out).unwrap();
            list::readable(&entry, &device, place, &mut out);
            list::plain(&entry, &device, place, &mut out);
            list::dump(&entry, &device, place, &mut out);
            assert_eq!(said.len(), 4, "{scope:?}: {said:?}");
            for line in said {
                assert!(
                    line.starts_with(['+', 'A', 'P']) && line.ends_with("********"),
                    "{scope:?}: {line}"
                );
            }
        }
    }
}

#[test]
fn a_mask_that_is_sent_again_leaves_the_secret_as_it_is() {
    let mut device = Model::default();
    device.settings.serial = settings::Text::new("open sesame").unwrap();
    let before = device.settings;
    let run = place(Port::Console, State::Run);
    for line in [
        "AT+SERIAL_NUMBER=********",
        "AT+MAVLINK_ID=********,********",
    ] {
        assert_eq!(told(&mut device, run, line), ["OK"], "{line}");
    }
    assert_eq!(device.settings, before);
}

#[test]
fn a_refusal_never_repeats_what_was_typed() {
    let mut device = Model::default();
    for state in [State::Run, CONFIGURATION] {
        for entry in settings::ENTRIES {
            let line = std::format!("AT+{}=open sesame,sesame,sesame,sesame,sesame", entry.name);
            for said in told(&mut device, place(Port::Console, state), &line) {
                assert!(!said.contains("sesame"), "{line}: {said}");
            }
        }
    }
}

#[test]
fn what_the_trigger_levels_read_is_told_under_the_name_as_typed() {
    let mut device = Model::default();
    let run = place(Port::Console, State::Run);
    for line in ["AT+TL_READ", "AT+TL_READ?"] {
        assert_eq!(told(&mut device, run, line), ["+TL_READ=1300"]);
    }
    assert_eq!(told(&mut device, run, "AT+MTLREAD"), ["+MTLREAD=1300"]);
    let configuration = place(Port::Console, CONFIGURATION);
    assert_eq!(
        told(&mut device, configuration, "AT+mtlread?"),
        ["AT+TL_READ=1300"]
    );
}

#[test]
fn a_test_tells_its_checks_in_run_and_the_first_failure_in_configuration() {
    let mut device = Model::default();
    let run = place(Port::Console, State::Run);
    let configuration = place(Port::Console, CONFIGURATION);
    assert_eq!(told(&mut device, run, "AT+TEST"), ["EEPROM: PASS", "OK"]);
    assert_eq!(told(&mut device, configuration, "AT+TEST"), ["AT+OK"]);
    device.broken = Some("EEPROM does not answer");
    assert_eq!(
        told(&mut device, run, "AT+TEST"),
        ["EEPROM: FAIL", "ERROR EEPROM does not answer"]
    );
    assert_eq!(
        told(&mut device, configuration, "AT+TEST"),
        ["AT+ERROR (EEPROM does not answer)"]
    );
}

#[test]
fn a_gain_is_told_as_set_and_as_read_back() {
    let mut device = Model {
        has_gain: true,
        ..Model::default()
    };
    let run = place(Port::Console, State::Run);
    assert_eq!(
        told(&mut device, run, "AT+RX_GAIN=100"),
        ["+RX_GAIN=100", "OK"]
    );
    assert_eq!(told(&mut device, run, "AT+RX_GAIN?"), ["+RX_GAIN=100(100)"]);
    assert_eq!(
        told(&mut device, run, "AT+RX_GAIN=102"),
        ["ERROR must be 1 to 101"]
    );
    assert_eq!(device.settings.rx_gain, 100);
}

#[test]
fn every_entry_describes_itself_or_says_that_it_does_not() {
    let mut device = Model::default();
    let place = place(Port::CommsUart, CONFIGURATION);
    for entry in settings::ENTRIES {
        let said = told(&mut device, place, &std::format!("AT+{}=?", entry.name));
        match entry.what {
            What::Command { .. } => assert!(said[0].starts_with("AT+ERROR ("), "{said:?}"),
            _ => assert_eq!(said.len(), 8, "{said:?}"),
        }
    }
}

#[test]
fn help_in_run_is_a_line_a_command_and_ends() {
    let mut device = Model::default();
    let said = told(&mut device, place(Port::Console, State::Run), "AT+HELP");
    assert_eq!(said.len(), settings::ENTRIES.len() + 1);
    for (line, entry) in said.iter().zip(settings::ENTRIES) {
        let (name, help) = line.split_once(':').unwrap();
        assert_eq!(name, entry.name);
        assert!(help.starts_with(entry.help));
    }
    assert_eq!(said.last().map(String::as_str), Some("OK"));
}
