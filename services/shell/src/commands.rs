//! The table of commands: what parses, what it asks for, and its help line.
//!
//! | command | bare | `?` | `=` |
//! |---|---|---|---|
//! | `HELP` | lists the commands | | |
//! | `STATS` | | counters of every stage | |
//! | `PROTOCOL` | | protocol of each interface | `<iface>,<protocol>` |
//! | `BAUDRATE`, alias `BAUD_RATE` | | actual rates | `<iface>,<rate>` |
//! | `REBOOT` | restarts the device | | |
//! | `INFO` | what the device is, what runs, its last crash | | |
//! | `BOOT_USB_UF2` | ends in the ROM's USB drive, if enabled | whether it is | `1` enables it until the next start, `0` takes that back |

use crate::command::{Command, Kind, arguments};
use crate::ports::{HIGHEST_BAUD, LOWEST_BAUD, Port, Protocol, Uart};
use crate::refusal::Refusal;

/// What a line asks for. `None` in a setting is a blank argument: leave it as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// `AT+HELP`: print [`help_lines`], then `OK`.
    Help,
    /// `AT+STATS?`
    QueryStatistics,
    /// `AT+PROTOCOL?`
    QueryProtocol,
    /// `AT+PROTOCOL=<iface>,<protocol>`
    SetProtocol {
        /// Which interface.
        port: Option<Port>,
        /// Which protocol it shall report.
        protocol: Option<Protocol>,
    },
    /// `AT+BAUDRATE?`
    QueryBaudRate,
    /// `AT+BAUDRATE=<iface>,<rate>`
    SetBaudRate {
        /// Which UART.
        uart: Option<Uart>,
        /// Bits a second, within [`LOWEST_BAUD`] and [`HIGHEST_BAUD`].
        baud: Option<u32>,
    },
    /// `AT+REBOOT`
    Reboot,
    /// `AT+REBOOT_BOOTLOADER`
    RebootBootloader,
    /// `AT+INFO`
    Info,
    /// `AT+BOOT_USB_UF2`
    BootUsbUf2,
    /// `AT+BOOT_USB_UF2?`
    QueryBootUsbUf2,
    /// `AT+BOOT_USB_UF2=<0|1>`
    EnableBootUsbUf2(bool),
}

/// One row of the table.
struct Row {
    name: &'static str,
    alias: Option<&'static str>,
    help: &'static str,
    request: fn(Kind<'_>) -> Result<Request, Refusal>,
}

static TABLE: [Row; 8] = [
    Row {
        name: "HELP",
        alias: None,
        help: "Lists the commands.",
        request: |kind| bare(kind, Request::Help),
    },
    Row {
        name: "STATS",
        alias: None,
        help: "AT+STATS? prints what every stage was offered, passed and refused.",
        request: |kind| query(kind, Request::QueryStatistics),
    },
    Row {
        name: "PROTOCOL",
        alias: None,
        help: "AT+PROTOCOL=<CONSOLE|COMMS_UART>,<NONE|RAW|BEAST|CSBEE> sets what an interface reports; AT+PROTOCOL? tells it.",
        request: protocol,
    },
    Row {
        name: "BAUDRATE",
        alias: Some("BAUD_RATE"),
        help: "AT+BAUDRATE=<COMMS_UART|GNSS_UART>,<9600-3000000> sets a rate; AT+BAUDRATE? tells the actual ones.",
        request: baud_rate,
    },
    Row {
        name: "REBOOT",
        alias: None,
        help: "Restarts the device.",
        request: |kind| bare(kind, Request::Reboot),
    },
    Row {
        name: "REBOOT_BOOTLOADER",
        alias: None,
        help: "Restarts into the bootloader, which then stays until AT+LOCK=0.",
        request: |kind| bare(kind, Request::RebootBootloader),
    },
    Row {
        name: "INFO",
        alias: None,
        help: "Tells what the device is, what runs and why it started, and its last crash.",
        request: |kind| bare(kind, Request::Info),
    },
    Row {
        name: "BOOT_USB_UF2",
        alias: None,
        help: "Ends in the chip's own USB drive, once AT+BOOT_USB_UF2=1 has enabled that; it forgets who may sign firmware.",
        request: boot_usb_uf2,
    },
];

/// The request of a line without its end.
pub fn request(line: &str) -> Result<Request, Refusal> {
    let command = Command::parse(line)?;
    let row = TABLE
        .iter()
        .find(|row| row.name == command.name || row.alias == Some(command.name))
        .ok_or(Refusal::UnknownCommand)?;
    (row.request)(command.kind)
}

/// Name and help text of every command, for `<name>:<help>` lines.
pub fn help_lines() -> impl Iterator<Item = (&'static str, &'static str)> {
    TABLE.iter().map(|row| (row.name, row.help))
}

fn bare(kind: Kind<'_>, request: Request) -> Result<Request, Refusal> {
    match kind {
        Kind::Bare => Ok(request),
        Kind::Query => Err(Refusal::NoQuery),
        Kind::Set(_) => Err(Refusal::NoSet),
    }
}

fn query(kind: Kind<'_>, request: Request) -> Result<Request, Refusal> {
    match kind {
        Kind::Query => Ok(request),
        Kind::Bare => Err(Refusal::NotBare),
        Kind::Set(_) => Err(Refusal::NoSet),
    }
}

fn boot_usb_uf2(kind: Kind<'_>) -> Result<Request, Refusal> {
    match kind {
        Kind::Bare => Ok(Request::BootUsbUf2),
        Kind::Query => Ok(Request::QueryBootUsbUf2),
        Kind::Set("0") => Ok(Request::EnableBootUsbUf2(false)),
        Kind::Set("1") => Ok(Request::EnableBootUsbUf2(true)),
        Kind::Set(_) => Err(Refusal::NotABit),
    }
}

fn protocol(kind: Kind<'_>) -> Result<Request, Refusal> {
    let Kind::Set(text) = kind else {
        return query(kind, Request::QueryProtocol);
    };
    let [port, protocol] = arguments(text)?;
    Ok(Request::SetProtocol {
        port: port
            .map(|name| Port::from_name(name).ok_or(Refusal::UnknownInterface))
            .transpose()?,
        protocol: protocol
            .map(|name| Protocol::from_name(name).ok_or(Refusal::UnknownProtocol))
            .transpose()?,
    })
}

fn baud_rate(kind: Kind<'_>) -> Result<Request, Refusal> {
    let Kind::Set(text) = kind else {
        return query(kind, Request::QueryBaudRate);
    };
    let [uart, baud] = arguments(text)?;
    Ok(Request::SetBaudRate {
        uart: uart
            .map(|name| Uart::from_name(name).ok_or(Refusal::UnknownInterface))
            .transpose()?,
        baud: baud.map(rate).transpose()?,
    })
}

fn rate(digits: &str) -> Result<u32, Refusal> {
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(Refusal::NotANumber);
    }
    // More digits than a u32 holds are a number all the same: out of range.
    let rate = digits.parse().unwrap_or(u32::MAX);
    if (LOWEST_BAUD..=HIGHEST_BAUD).contains(&rate) {
        Ok(rate)
    } else {
        Err(Refusal::BaudRateRange)
    }
}
