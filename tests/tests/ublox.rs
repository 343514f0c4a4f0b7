//! A u-blox is set up: what it is told, read by pyubx2, and the shipped image with receivers that obey, refuse, ignore and forget.

use serde_json::Value;
use tests::clients::Client;
use tests::timing::device::Device;
use twin::board::gnss::Options;
use twin::board::gnss::ublox::Ublox;
use twin::chip::crystal::Deviation;
use twin::chip::outside::Outside;
use ubx::{Configurator, MESSAGES, State};

/// Keys with the layers that they act on.
fn in_ram<'a>(keys: &[(&'a str, i64)]) -> Vec<(&'a str, i64)> {
    let layers = [("version", 0), ("ram", 1), ("bbr", 0), ("flash", 0)];
    [&layers[..], keys].concat()
}

/// What a message is answered with, and its answers as pyubx2 writes them.
fn read() -> Vec<Value> {
    let stream: Vec<u8> = MESSAGES.iter().flat_map(|m| m.bytes).copied().collect();
    let read = Client::Ubx.read(&stream);
    assert_eq!(read.len(), MESSAGES.len());
    read
}

fn bytes(value: &Value) -> Vec<u8> {
    let hex = value.as_str().expect("hexadecimal");
    (0..hex.len() / 2)
        .map(|n| u8::from_str_radix(&hex[2 * n..2 * n + 2], 16).expect("digits"))
        .collect()
}

#[test]
fn pyubx2_reads_every_message_as_it_is_meant() {
    let pulse = [
        ("CFG_TP_PULSE_DEF", 0),
        ("CFG_TP_PULSE_LENGTH_DEF", 1),
        ("CFG_TP_ANT_CABLEDELAY", 0),
        ("CFG_TP_PERIOD_TP1", 1_000_000),
        ("CFG_TP_PERIOD_LOCK_TP1", 1_000_000),
        ("CFG_TP_LEN_TP1", 0),
        ("CFG_TP_LEN_LOCK_TP1", 100_000),
        ("CFG_TP_USER_DELAY_TP1", 0),
        ("CFG_TP_TP1_ENA", 1),
        ("CFG_TP_SYNC_GNSS_TP1", 1),
        ("CFG_TP_USE_LOCKED_TP1", 1),
        ("CFG_TP_ALIGN_TO_TOW_TP1", 1),
        ("CFG_TP_POL_TP1", 1),
        ("CFG_TP_TIMEGRID_TP1", 0),
    ];
    let sentences = [("GSV", 0), ("GLL", 0), ("VTG", 0), ("RMC", 1)]
        .into_iter()
        .chain([("GGA", 1), ("GSA", 1), ("GST", 1), ("ZDA", 1)]);
    let keys: Vec<_> = sentences
        .clone()
        .map(|(name, on)| (format!("CFG_MSGOUT_NMEA_ID_{name}_UART1"), on))
        .collect();
    let keys: Vec<_> = keys.iter().map(|(name, on)| (name.as_str(), *on)).collect();
    let rate_keys = [
        ("CFG_RATE_MEAS", 1_000),
        ("CFG_RATE_NAV", 1),
        ("CFG_RATE_TIMEREF", 0),
    ];
    let mut expected = vec![
        ("CFG-VALSET", in_ram(&pulse)),
        ("CFG-VALSET", in_ram(&keys)),
        ("CFG-VALSET", in_ram(&rate_keys)),
        (
            "CFG-TP5",
            [
                ("tpIdx", 0),
                ("antCableDelay", 0),
                ("freqPeriod", 1_000_000),
                ("freqPeriodLock", 1_000_000),
                ("pulseLenRatio", 0),
                ("pulseLenRatioLock", 100_000),
                ("userConfigDelay", 0),
                ("active", 1),
                ("lockGnssFreq", 1),
                ("lockedOtherSet", 1),
                ("isFreq", 0),
                ("isLength", 1),
                ("alignToTow", 1),
                ("polarity", 1),
                ("gridUtcGnss", 0),
            ]
            .to_vec(),
        ),
        (
            "CFG-RATE",
            [("measRate", 1_000), ("navRate", 1), ("timeRef", 0)].to_vec(),
        ),
    ];
    // The short form has one rate, for the port it comes in on; pyubx2 calls it as the long form's first.
    let ids = [3, 1, 5, 4, 0, 2, 7, 8];
    for (id, (_, on)) in ids.into_iter().zip(sentences) {
        expected.push((
            "CFG-MSG",
            [("msgClass", 0xF0), ("msgID", id), ("rateDDC", on)].to_vec(),
        ));
    }
    for ((name, fields), told) in expected.iter().zip(read()) {
        assert_eq!(told["message"], *name);
        for (field, value) in fields {
            assert_eq!(
                told["fields"][field].as_i64(),
                Some(*value),
                "{name} {field}: {told}"
            );
        }
    }
}

#[test]
fn answers_as_pyubx2_writes_them_are_understood() {
    let read = read();
    let talk = |answer: &dyn Fn(usize) -> &'static str| {
        let mut asker = Configurator::new();
        asker.want(true);
        let mut asked = 0;
        for now_ms in (0..30_000).step_by(100) {
            let Some(message) = asker.due(now_ms) else {
                continue;
            };
            asker.sent(now_ms);
            asked += 1;
            let place = MESSAGES
                .iter()
                .position(|m| m.bytes == message)
                .expect("one of them");
            for byte in bytes(&read[place][answer(place)]) {
                assert!(asker.feed(byte, now_ms));
            }
        }
        (asker.state(), asked)
    };
    assert_eq!(talk(&|_| "taken"), (State::Configured, 3));
    let older = talk(&|place| if place == 0 { "refused" } else { "taken" });
    assert_eq!(older, (State::Configured, 11));
    assert_eq!(talk(&|_| "refused"), (State::Refused("CFG-TP5"), 11));
}

/// A device that has run for five seconds.
fn device(ublox: Ublox) -> Device {
    let options = Options {
        ublox: Some(ublox),
        ..Options::default()
    };
    let mut device = Device::start(Deviation::default(), options);
    device.ask("AT+LOG_LEVEL=INFO");
    device.board.gnss_read();
    device.run_ms(1_000);
    device
}

fn sends(device: &mut Device, letters: &str) -> bool {
    device
        .board
        .gnss()
        .expect("it is fitted")
        .memory
        .sends(letters)
}

/// Runs until the configuration is through; what CONSOLE said, and the outcome.
fn outcome(device: &mut Device, within_s: u64) -> (String, String) {
    let mut said = String::new();
    for _ in 0..within_s * 2 {
        device.run_ms(500);
        said.push_str(&String::from_utf8_lossy(&device.board.console_read()));
        let config = device.gnss("config").expect("it is told");
        if config != "ASKING" {
            device.run_ms(1_100);
            said.push_str(&String::from_utf8_lossy(&device.board.console_read()));
            return (said, config);
        }
    }
    panic!("no outcome in {within_s} s: {said}");
}

/// Sentences with faults so far.
fn faults(device: &mut Device) -> [Option<String>; 3] {
    ["bad_checksum", "broken_off", "lost"].map(|name| device.gnss(name))
}

fn zeros() -> [Option<String>; 3] {
    [(); 3].map(|()| Some("0".to_string()))
}

#[test]
fn a_ublox_is_set_up_when_asked_for_and_again_after_it_forgot_and_after_a_restart() {
    let mut device = device(Ublox::Keys);
    assert_eq!(device.board.gnss_read(), b"");
    assert_eq!(device.gnss("config").as_deref(), Some("OFF"));
    assert!(sends(&mut device, "GSV") && !sends(&mut device, "ZDA"));

    assert!(device.ask("AT+GNSS_CONFIG=UBLOX").contains("OK"));
    let (said, config) = outcome(&mut device, 3);
    assert_eq!(config, "CONFIGURED");
    assert!(said.contains("[INFO] GNSS receiver configured"), "{said}");
    assert!(!sends(&mut device, "GSV") && sends(&mut device, "ZDA"));
    assert_eq!(device.board.gnss().unwrap().memory.taken, [[6, 0x8A]; 3]);
    let told = device.board.gnss_read();
    assert_eq!(Client::Ubx.read(&told).len(), 3);
    // What is passed on is sentences alone, and time goes on.
    device.ask("AT+PROTOCOL=CONSOLE,NONE");
    assert!(device.ask("AT+GNSS_LOG=CONSOLE,ALL").contains("OK"));
    device.run_ms(3_000);
    let passed = String::from_utf8(device.board.console_read()).expect("text alone");
    let is_sentence = |line: &str| line.starts_with("$GN") && !line.starts_with("$GNVTG");
    assert!(
        passed.lines().count() >= 10 && passed.lines().all(is_sentence),
        "{passed}"
    );
    device.ask("AT+GNSS_LOG=CONSOLE,NONE");
    assert_eq!(faults(&mut device), zeros());

    // Off for a moment: it sends GSV again until it is told anew.
    let now_ps = device.board.chip.bus.true_ps();
    let receiver = device.board.gnss().unwrap();
    receiver.power(false, now_ps);
    receiver.power(true, now_ps);
    assert!(sends(&mut device, "GSV"));
    device.run_ms(11_000);
    assert!(!sends(&mut device, "GSV"));
    assert_eq!(device.gnss("config").as_deref(), Some("CONFIGURED"));
    assert_eq!(device.gnss("state").as_deref(), Some("LOCKED"));

    // Kept over a restart, and told again.
    let mut said = device.ask("AT+SETTINGS=SAVE");
    device.run_ms(500);
    said.push_str(&String::from_utf8_lossy(&device.board.console_read()));
    assert!(said.contains("OK"), "{said}");
    let receiver = device.board.gnss().unwrap();
    receiver.power(false, 0);
    receiver.power(true, 0);
    device.ask("AT+REBOOT");
    device.run_ms(7_000);
    assert!(!sends(&mut device, "GSV"));
}

#[test]
fn an_older_ublox_is_set_up_by_messages_with_rubbish_between() {
    for kind in [Ublox::Messages, Ublox::IgnoresKeys] {
        let mut device = device(kind);
        device.ask("AT+GNSS_CONFIG=UBLOX");
        // Answers cut short, of others, with a wrong sum, and sync bytes.
        device.board.gnss_write(&[
            0xB5, 0x62, 5, 0xB5, 0xB5, 0x62, 5, 0, 2, 0, 6, 0x24, 0x31, 0x9C,
        ]);
        device
            .board
            .gnss_write(&[0xB5, 0x62, 5, 1, 2, 0, 6, 0x8A, 0, 0, 0xFF]);
        let (_, config) = outcome(&mut device, 12);
        assert_eq!(config, "CONFIGURED", "{kind:?}");
        assert!(!sends(&mut device, "GSV") && sends(&mut device, "ZDA"));
        let taken = device.board.gnss().unwrap().memory.taken.clone();
        assert_eq!(taken[..2], [[6, 0x31], [6, 8]], "{kind:?}");
        assert_eq!(taken[2..], [[6, 1]; 8], "{kind:?}");
        assert_eq!(device.gnss("state").as_deref(), Some("LOCKED"));
        assert_eq!(faults(&mut device), zeros());
    }
}

#[test]
fn what_a_ublox_refuses_and_one_that_is_deaf_are_told() {
    let mut stubborn = device(Ublox::FixedRate);
    stubborn.ask("AT+GNSS_CONFIG=UBLOX");
    let (said, config) = outcome(&mut stubborn, 5);
    assert_eq!(config, "REFUSED");
    assert_eq!(
        stubborn.gnss("refused_message").as_deref(),
        Some("CFG-RATE")
    );
    assert!(
        said.contains("[WARNINGS] GNSS receiver refused CFG-RATE"),
        "{said}"
    );
    assert!(!sends(&mut stubborn, "GSV"));

    let mut deaf = device(Ublox::Deaf);
    deaf.ask("AT+GNSS_CONFIG=UBLOX");
    let (said, config) = outcome(&mut deaf, 12);
    assert_eq!(config, "NO_ANSWER");
    assert!(
        said.contains("[WARNINGS] GNSS receiver does not answer"),
        "{said}"
    );
    // Its sentences and pulses serve all the same, and nothing more is sent.
    deaf.board.gnss_read();
    deaf.run_ms(3_000);
    assert_eq!(deaf.board.gnss_read(), b"");
    assert_eq!(deaf.gnss("state").as_deref(), Some("LOCKED"));
    deaf.ask("AT+GNSS_CONFIG=OFF");
    assert_eq!(deaf.gnss("config").as_deref(), Some("OFF"));
}
