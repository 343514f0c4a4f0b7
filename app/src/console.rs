//! CONSOLE's commands, carried out: the ADSBee dialect of RUN, as far as it is built (`shell` parses it).
//!
//! A reply is one or more whole lines with `\r\n`; like every message it is dropped and counted when the port has no room.

use crate::outlets;
use crate::receiver::{Receiver, UsbDrive};
use boot_contract::hand_over::{Cause, HandOver};
use core::fmt::{self, Write};
use hal::usb::PACKET;
use reporter::{Kind, Outlet, Port, Reporter};
use shell::{BaudRateReply, LineReader, OK, ProtocolReply, Refusal, Request, Uart, help_lines};

/// Bytes of the longest reply line and its end.
const MAX_REPLY: usize = crate::stats::MAX_LINE + 2;

/// Lines that one packet can end: the shortest line is one byte and its end. All are answered before the next packet is taken.
const LINES_A_PACKET: usize = PACKET / 2;

/// CONSOLE's input.
pub struct Console {
    reader: LineReader,
    waiting: heapless::Deque<Result<Request, Refusal>, LINES_A_PACKET>,
}

impl Console {
    /// At the start of a line.
    pub const fn new() -> Self {
        Self {
            reader: LineReader::new(),
            waiting: heapless::Deque::new(),
        }
    }

    /// Takes what has arrived and moves what waits to be sent. Returns whether anything moved, and the commands that found no
    /// place (none, as long as each turn answers them all).
    pub fn poll(&mut self, port: &mut Reporter<outlets::Console>) -> (bool, u32) {
        let mut lost = 0;
        let (mut bytes, mut count) = ([0; PACKET], 0);
        let moved = port.port.outlet.0.poll(|byte| {
            bytes[count] = byte;
            count += 1;
        });
        for &byte in &bytes[..count] {
            if let Some(byte) = port.heard(byte)
                && let Some(command) = self.reader.feed(byte)
                && self.waiting.push_back(command).is_err()
            {
                lost += 1;
            }
        }
        (moved, lost)
    }

    /// The next command to answer.
    pub fn next(&mut self) -> Option<Result<Request, Refusal>> {
        self.waiting.pop_front()
    }
}

/// Carries out one command and replies on CONSOLE.
pub fn answer(command: Result<Request, Refusal>, receiver: &mut Receiver) {
    let request = match command {
        Ok(request) => request,
        Err(refusal) => return reply(&mut receiver.console.port, format_args!("{refusal}")),
    };
    match request {
        Request::Help => {
            for (name, help) in help_lines() {
                reply(&mut receiver.console.port, format_args!("{name}:{help}"));
            }
            reply(&mut receiver.console.port, format_args!("{OK}"));
        }
        Request::QueryStatistics => receiver.tell_statistics(|port, line| match line {
            Ok(line) => reply(port, format_args!("{line}")),
            Err(fmt::Error) => port.dropped_unmade(Kind::Reply, 1),
        }),
        Request::QueryProtocol => {
            let text = ProtocolReply {
                console: shown(receiver.settings.console.protocol()),
                comms_uart: shown(receiver.settings.comms_uart.protocol()),
            };
            reply(&mut receiver.console.port, format_args!("{text}"));
        }
        Request::SetProtocol { port, protocol } => {
            if let (Some(port), Some(protocol)) = (port, protocol) {
                let port = match port {
                    shell::Port::Console => &mut receiver.settings.console,
                    shell::Port::CommsUart => &mut receiver.settings.comms_uart,
                };
                port.set_protocol(meant(protocol));
                receiver.apply();
            }
            reply(&mut receiver.console.port, format_args!("{OK}"));
        }
        Request::QueryBaudRate => {
            // GNSS_UART is not driven yet: rate 0.
            let text = BaudRateReply {
                comms_uart: receiver.comms.port.outlet.0.baud(),
                gnss_uart: 0,
            };
            reply(&mut receiver.console.port, format_args!("{text}"));
        }
        Request::SetBaudRate {
            uart: Some(Uart::Comms),
            baud: Some(baud),
        } => {
            let done = receiver.comms.port.outlet.0.request_baud(baud).is_some();
            let text = if done {
                OK
            } else {
                "ERROR baud rate out of range"
            };
            reply(&mut receiver.console.port, format_args!("{text}"));
        }
        Request::SetBaudRate {
            uart: Some(Uart::Gnss),
            baud: Some(_),
        } => {
            reply(
                &mut receiver.console.port,
                format_args!("ERROR GNSS_UART is not built yet"),
            );
        }
        Request::SetBaudRate { .. } => reply(&mut receiver.console.port, format_args!("{OK}")),
        Request::Reboot => {
            reply(&mut receiver.console.port, format_args!("{OK}"));
            receiver.reboot_soon(HandOver::Restart(Cause::Command));
        }
        Request::RebootBootloader => {
            reply(&mut receiver.console.port, format_args!("{OK}"));
            receiver.reboot_soon(HandOver::Stay(Cause::Command));
        }
        Request::Info => crate::info::tell(receiver),
        Request::BootUsbUf2 if receiver.usb_drive == UsbDrive::Enabled => {
            reply(&mut receiver.console.port, format_args!("{OK}"));
            receiver.usb_drive_soon();
        }
        Request::BootUsbUf2 => reply(
            &mut receiver.console.port,
            format_args!("ERROR not enabled, AT+BOOT_USB_UF2=1 does that"),
        ),
        Request::QueryBootUsbUf2 => {
            let enabled = u8::from(receiver.usb_drive == UsbDrive::Enabled);
            reply(
                &mut receiver.console.port,
                format_args!("+BOOT_USB_UF2={enabled}"),
            );
        }
        Request::EnableBootUsbUf2(enable) => {
            receiver.usb_drive = if enable {
                UsbDrive::Enabled
            } else {
                UsbDrive::Disabled
            };
            reply(&mut receiver.console.port, format_args!("{OK}"));
        }
    }
}

/// A protocol as the commands name it.
fn meant(protocol: shell::Protocol) -> settings::choices::Protocol {
    use settings::choices::Protocol;
    match protocol {
        shell::Protocol::None => Protocol::None,
        shell::Protocol::Raw => Protocol::Raw,
        shell::Protocol::Beast => Protocol::Beast,
        shell::Protocol::Csbee => Protocol::Csbee,
    }
}

/// The other way round.
fn shown(protocol: settings::choices::Protocol) -> shell::Protocol {
    use settings::choices::Protocol;
    match protocol {
        Protocol::Raw => shell::Protocol::Raw,
        Protocol::Beast => shell::Protocol::Beast,
        Protocol::Csbee => shell::Protocol::Csbee,
        _ => shell::Protocol::None,
    }
}

/// One reply line.
pub fn reply<O: Outlet>(port: &mut Port<O>, text: fmt::Arguments<'_>) {
    let mut line = heapless::String::<MAX_REPLY>::new();
    match write!(line, "{text}\r\n") {
        Ok(()) => port.message(Kind::Reply, line.as_bytes()),
        Err(fmt::Error) => port.dropped_unmade(Kind::Reply, 1),
    }
}
