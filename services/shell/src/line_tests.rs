//! Byte streams as a port delivers them.

use super::*;
use proptest::prelude::*;
use std::string::{String, ToString};
use std::vec::Vec;

fn told(bytes: &[u8]) -> Vec<String> {
    let mut reader = LineReader::new();
    let mut told = Vec::new();
    for &byte in bytes {
        match reader.feed(byte) {
            Some(Input::Line(line)) => told.push(line.to_string()),
            Some(Input::TooLong) => told.push("too long".to_string()),
            None => {}
        }
    }
    told
}

#[test]
fn every_line_end_and_no_answer_to_an_empty_line() {
    for text in [
        "AT+HELP\r\n",
        "AT+HELP\n",
        "AT+HELP\r",
        "\r\n\nAT+HELP\r\n\r\n",
    ] {
        assert_eq!(told(text.as_bytes()), ["AT+HELP"], "{text:?}");
    }
    assert_eq!(told(b"AT+HELP\rhello\nAT\r\n"), ["AT+HELP", "hello", "AT"]);
}

#[test]
fn a_long_line_is_refused_once_and_the_next_is_read() {
    let mut bytes = Vec::from(&b"AT+PROTOCOL="[..]);
    bytes.resize(3 * LINE_BYTES, b'A');
    bytes.extend(b"\r\nAT+HELP\r\n");
    assert_eq!(told(&bytes), ["too long", "AT+HELP"]);
    let fits = std::format!("{:A<LINE_BYTES$}\n", "AT+");
    assert_eq!(told(fits.as_bytes()), [fits.trim_end()]);
}

#[test]
fn binary_bytes_are_never_answered() {
    assert_eq!(told(b"\x1a1C\x1a1d\r\n"), [""; 0]);
    assert_eq!(
        told(b"\x00\xff garbage with text \r\nAT+HELP\r\n"),
        ["AT+HELP"]
    );
}

#[test]
fn a_command_right_behind_binary_bytes_is_read() {
    assert_eq!(told(b"\x1a3\x80\xfeAAT+HELP\n"), ["AT+HELP"]);
    assert_eq!(told(b"AT+PROT\x00AT+HELP\n"), ["AT+HELP"]);
    assert_eq!(told(b"\x1a1JAT+CONFIG=1\n"), ["AT+CONFIG=1"]);
    // The letters of the prefix must stand together.
    assert_eq!(told(b"\x80A-T-+HELP\n"), [""; 0]);
}

#[test]
fn binary_bytes_inside_a_command_void_it() {
    assert_eq!(told(b"AT+HE\x07LP\r\n"), [""; 0]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2048, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_read_without_panic_and_a_command_behind_them_is_heard(
        garbage in prop::collection::vec(prop_oneof![any::<u8>(), Just(b'A'), Just(b'T'), Just(b'+'), Just(b'=')], 0..400),
    ) {
        let mut bytes = garbage;
        bytes.extend(b"\r\nAT+STATS?\r\n");
        prop_assert_eq!(told(&bytes).pop(), Some("AT+STATS?".to_string()));
    }
}
