//! Byte streams as a port delivers them.

use super::*;
use crate::ports::{HIGHEST_BAUD, Port, Protocol, Uart};
use proptest::prelude::*;
use std::vec::Vec;

fn told(bytes: &[u8]) -> Vec<Result<Request, Refusal>> {
    let mut reader = LineReader::new();
    bytes.iter().filter_map(|&byte| reader.feed(byte)).collect()
}

fn only(line: &str) -> Result<Request, Refusal> {
    let told = told(std::format!("{line}\r\n").as_bytes());
    assert_eq!(told.len(), 1, "{line}");
    told[0]
}

#[test]
fn every_request() {
    for (line, request) in [
        ("AT+HELP", Request::Help),
        ("AT+STATS?", Request::QueryStatistics),
        ("AT+PROTOCOL?", Request::QueryProtocol),
        ("AT+BAUDRATE?", Request::QueryBaudRate),
        ("AT+BAUD_RATE?", Request::QueryBaudRate),
        ("AT+REBOOT", Request::Reboot),
        ("AT+INFO", Request::Info),
        ("AT+BOOT_USB_UF2", Request::BootUsbUf2),
        ("AT+BOOT_USB_UF2?", Request::QueryBootUsbUf2),
        ("AT+BOOT_USB_UF2=1", Request::EnableBootUsbUf2(true)),
        ("AT+BOOT_USB_UF2=0", Request::EnableBootUsbUf2(false)),
        (
            "AT+PROTOCOL=CONSOLE,NONE",
            Request::SetProtocol {
                port: Some(Port::Console),
                protocol: Some(Protocol::None),
            },
        ),
        (
            "AT+PROTOCOL=COMMS,BEAST",
            Request::SetProtocol {
                port: Some(Port::CommsUart),
                protocol: Some(Protocol::Beast),
            },
        ),
        (
            "AT+BAUDRATE=COMMS_UART,115200",
            Request::SetBaudRate {
                uart: Some(Uart::Comms),
                baud: Some(115_200),
            },
        ),
        (
            "AT+BAUDRATE=COMMS,3000000",
            Request::SetBaudRate {
                uart: Some(Uart::Comms),
                baud: Some(HIGHEST_BAUD),
            },
        ),
        (
            "AT+BAUD_RATE=GNSS,9600",
            Request::SetBaudRate {
                uart: Some(Uart::Gnss),
                baud: Some(9_600),
            },
        ),
    ] {
        assert_eq!(only(line), Ok(request), "{line}");
    }
}

#[test]
fn blank_arguments_are_left_unchanged() {
    assert_eq!(
        only("AT+PROTOCOL=,RAW"),
        Ok(Request::SetProtocol {
            port: None,
            protocol: Some(Protocol::Raw)
        })
    );
    assert_eq!(
        only("AT+BAUDRATE=COMMS,"),
        Ok(Request::SetBaudRate {
            uart: Some(Uart::Comms),
            baud: None
        })
    );
}

#[test]
fn every_refusal() {
    for (line, refusal) in [
        ("hello", Refusal::NotACommand),
        ("at+help", Refusal::NotACommand),
        ("AT", Refusal::NotACommand),
        ("AT+", Refusal::UnknownCommand),
        ("AT+help", Refusal::UnknownCommand),
        ("AT+WIFI?", Refusal::UnknownCommand),
        ("AT+HELP?", Refusal::NoQuery),
        ("AT+STATS??", Refusal::NoQuery),
        ("AT+REBOOT=1", Refusal::NoSet),
        ("AT+BOOT_USB_UF2=2", Refusal::NotABit),
        ("AT+BOOT_USB_UF2=", Refusal::NotABit),
        ("AT+STATS=1", Refusal::NoSet),
        ("AT+STATS", Refusal::NotBare),
        ("AT+PROTOCOL", Refusal::NotBare),
        ("AT+PROTOCOL=", Refusal::ArgumentCount),
        ("AT+PROTOCOL=CONSOLE", Refusal::ArgumentCount),
        ("AT+PROTOCOL=CONSOLE,RAW,1", Refusal::ArgumentCount),
        ("AT+PROTOCOL=GNSS_UART,RAW", Refusal::UnknownInterface),
        ("AT+PROTOCOL=CONSOLE, RAW", Refusal::UnknownProtocol),
        ("AT+PROTOCOL=CONSOLE,GDL90", Refusal::UnknownProtocol),
        ("AT+BAUDRATE=CONSOLE,9600", Refusal::UnknownInterface),
        ("AT+BAUDRATE=COMMS,fast", Refusal::NotANumber),
        ("AT+BAUDRATE=COMMS,+9600", Refusal::NotANumber),
        ("AT+BAUDRATE=COMMS,9599", Refusal::BaudRateRange),
        ("AT+BAUDRATE=COMMS,3000001", Refusal::BaudRateRange),
        ("AT+BAUDRATE=COMMS,99999999999", Refusal::BaudRateRange),
    ] {
        assert_eq!(only(line), Err(refusal), "{line}");
    }
}

#[test]
fn every_line_end_and_no_answer_to_an_empty_line() {
    for text in [
        "AT+HELP\r\n",
        "AT+HELP\n",
        "AT+HELP\r",
        "\r\n\nAT+HELP\r\n\r\n",
    ] {
        assert_eq!(told(text.as_bytes()), [Ok(Request::Help)], "{text:?}");
    }
}

#[test]
fn a_long_line_is_refused_once_and_the_next_is_read() {
    let mut bytes = Vec::from(&b"AT+PROTOCOL="[..]);
    bytes.resize(3 * LINE_BYTES, b'A');
    bytes.extend(b"\r\nAT+HELP\r\n");
    assert_eq!(told(&bytes), [Err(Refusal::LineTooLong), Ok(Request::Help)]);
    let fits = std::format!("{:A<LINE_BYTES$}\n", "AT+");
    assert_eq!(told(fits.as_bytes()), [Err(Refusal::UnknownCommand)]);
}

#[test]
fn binary_bytes_are_never_answered() {
    assert_eq!(told(b"\x1a1C\x1a1d\r\n"), []);
    assert_eq!(
        told(b"\x00\xff garbage with text \r\nAT+HELP\r\n"),
        [Ok(Request::Help)]
    );
}

#[test]
fn a_command_right_behind_binary_bytes_is_read() {
    assert_eq!(told(b"\x1a3\x80\xfeAAT+HELP\n"), [Ok(Request::Help)]);
    assert_eq!(told(b"AT+PROT\x00AT+HELP\n"), [Ok(Request::Help)]);
    // The letters of the prefix must stand together.
    assert_eq!(told(b"\x80A-T-+HELP\n"), []);
}

#[test]
fn binary_bytes_inside_a_command_void_it() {
    assert_eq!(told(b"AT+HE\x07LP\r\n"), []);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2048, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_read_without_panic_and_a_command_behind_them_is_heard(
        garbage in prop::collection::vec(prop_oneof![any::<u8>(), Just(b'A'), Just(b'T'), Just(b'+'), Just(b'=')], 0..400),
    ) {
        let mut bytes = garbage;
        bytes.extend(b"\r\nAT+STATS?\r\n");
        prop_assert_eq!(told(&bytes).pop(), Some(Ok(Request::QueryStatistics)));
    }
}
