//! The names that commands use for interfaces and protocols.
//!
//! `COMMS` and `GNSS`, as one page of the ADSBee document prints them, are accepted beside `COMMS_UART` and `GNSS_UART`; replies use
//! the long names.

/// An interface with a reporting protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// USB.
    Console,
    /// UART1.
    CommsUart,
}

/// An interface with a baud rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uart {
    /// UART1, reports.
    Comms,
    /// UART0, the GNSS receiver.
    Gnss,
}

/// A reporting protocol that is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// No data.
    None,
    /// Raw frames as text.
    Raw,
    /// Mode S Beast.
    Beast,
    /// CSBee.
    Csbee,
}

/// Lowest baud rate, bits a second.
pub const LOWEST_BAUD: u32 = 9_600;
/// Highest baud rate, bits a second.
pub const HIGHEST_BAUD: u32 = 3_000_000;

impl Port {
    /// The port of a name in a command.
    pub fn from_name(name: &str) -> Option<Port> {
        match name {
            "CONSOLE" => Some(Port::Console),
            "COMMS_UART" | "COMMS" => Some(Port::CommsUart),
            _ => None,
        }
    }

    /// The name in replies.
    pub const fn name(self) -> &'static str {
        match self {
            Port::Console => "CONSOLE",
            Port::CommsUart => "COMMS_UART",
        }
    }
}

impl Uart {
    /// The UART of a name in a command.
    pub fn from_name(name: &str) -> Option<Uart> {
        match name {
            "COMMS_UART" | "COMMS" => Some(Uart::Comms),
            "GNSS_UART" | "GNSS" => Some(Uart::Gnss),
            _ => None,
        }
    }
}

impl Protocol {
    /// Every protocol, in the order of the document.
    pub const ALL: [Protocol; 4] = [
        Protocol::None,
        Protocol::Raw,
        Protocol::Beast,
        Protocol::Csbee,
    ];

    /// The protocol of a name.
    pub fn from_name(name: &str) -> Option<Protocol> {
        Protocol::ALL.into_iter().find(|p| p.name() == name)
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Protocol::None => "NONE",
            Protocol::Raw => "RAW",
            Protocol::Beast => "BEAST",
            Protocol::Csbee => "CSBEE",
        }
    }
}
