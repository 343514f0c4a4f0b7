//! Replies as text, without the line end of their last line unless drawn here.

use crate::ports::{Port, Protocol};
use core::fmt;

/// The reply to a setting that was carried out.
pub const OK: &str = "OK";

/// `+PROTOCOL=CONSOLE,<name>\r\n+PROTOCOL=COMMS_UART,<name>`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProtocolReply {
    /// What CONSOLE reports.
    pub console: Protocol,
    /// What COMMS_UART reports.
    pub comms_uart: Protocol,
}

/// `+BAUDRATE=<rate>(COMMS_UART),<rate>(GNSS_UART)`: the rates the dividers give, not those asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaudRateReply {
    /// COMMS_UART, bits a second.
    pub comms_uart: u32,
    /// GNSS_UART, bits a second.
    pub gnss_uart: u32,
}

impl fmt::Display for ProtocolReply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (console, comms) = (Port::Console.name(), Port::CommsUart.name());
        write!(f, "+PROTOCOL={console},{}\r\n", self.console.name())?;
        write!(f, "+PROTOCOL={comms},{}", self.comms_uart.name())
    }
}

impl fmt::Display for BaudRateReply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let BaudRateReply {
            comms_uart,
            gnss_uart,
        } = self;
        write!(
            f,
            "+BAUDRATE={comms_uart}(COMMS_UART),{gnss_uart}(GNSS_UART)"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Refusal, help_lines};
    use std::string::ToString;

    #[test]
    fn replies_as_the_document_prints_them() {
        let protocols = ProtocolReply {
            console: Protocol::Csbee,
            comms_uart: Protocol::Beast,
        };
        assert_eq!(
            protocols.to_string(),
            "+PROTOCOL=CONSOLE,CSBEE\r\n+PROTOCOL=COMMS_UART,BEAST"
        );
        let rates = BaudRateReply {
            comms_uart: 115_207,
            gnss_uart: 9_600,
        };
        assert_eq!(
            rates.to_string(),
            "+BAUDRATE=115207(COMMS_UART),9600(GNSS_UART)"
        );
    }

    #[test]
    fn an_unknown_protocol_is_told_what_is_available() {
        assert_eq!(
            Refusal::UnknownProtocol.to_string(),
            "ERROR unknown protocol, available: NONE RAW BEAST CSBEE"
        );
    }

    #[test]
    fn help_has_a_line_for_each_command_and_the_rates_it_names_are_the_limits() {
        let names: std::vec::Vec<&str> = help_lines().map(|(name, _)| name).collect();
        assert_eq!(
            names,
            [
                "HELP",
                "STATS",
                "PROTOCOL",
                "BAUDRATE",
                "REBOOT",
                "REBOOT_BOOTLOADER",
                "INFO",
                "BOOT_USB_UF2"
            ]
        );
        let (_, help) = help_lines().find(|(name, _)| *name == "BAUDRATE").unwrap();
        let range = std::format!("{}-{}", crate::LOWEST_BAUD, crate::HIGHEST_BAUD);
        assert!(help.contains(&range));
        let (_, help) = help_lines().find(|(name, _)| *name == "PROTOCOL").unwrap();
        for protocol in Protocol::ALL {
            assert!(help.contains(protocol.name()));
        }
    }
}
