//! All serial ports of a running device, as pseudo-terminals or TCP ports, with the back-pressure of each.
//!
//! | port | TCP | a program that does not read | a program that writes faster than the device takes |
//! |---|---|---|---|
//! | CONSOLE | BASE | the USB host takes no more, the device keeps it | waits |
//! | COMMS_UART, GNSS_UART, ESP32 | BASE + 1 to 3 | bytes are lost and counted, as on a wire | waits for the line's rate |
//! | FLARM | BASE + 4 | – | waits for the line's rate |
//!
//! Whoever writes waits because the bytes stay in the pseudo-terminal or socket until the port has room: no queue grows without end.

use clap::ArgMatches;
use twin::board::{Board, PortName};

use crate::Failure;
use crate::ports::Port;

/// A port of the device and its end on this computer.
struct Served {
    name: &'static str,
    port: PortName,
    end: Port,
}

/// The ports, where they were asked for.
pub struct Serial(Vec<Served>);

impl Serial {
    /// Opens what `--serial` or `--tcp` ask for, and prints where each port is.
    pub fn open(matches: &ArgMatches) -> Result<Option<Self>, Failure> {
        let tcp = matches.get_one::<u16>("tcp");
        if !matches.get_flag("serial") && tcp.is_none() {
            return Ok(None);
        }
        let mut served = Vec::new();
        for (n, (name, port)) in [
            ("CONSOLE", PortName::Console),
            ("COMMS_UART", PortName::Comms),
            ("GNSS_UART", PortName::Gnss),
            ("ESP32", PortName::Esp32),
            ("FLARM", PortName::Flarm),
        ]
        .into_iter()
        .enumerate()
        {
            let end = match tcp {
                Some(base) => base
                    .checked_add(n as u16)
                    .ok_or_else(|| std::io::Error::other("the port number is above 65535"))
                    .and_then(Port::tcp),
                None => Port::pty(),
            }
            .map_err(|cause| Failure::Port { port: name, cause })?;
            eprintln!("{name:<10} {}", end.address);
            served.push(Served { name, port, end });
        }
        Ok(Some(Self(served)))
    }

    /// Moves bytes between device and programs. `said` is what CONSOLE said.
    pub fn exchange(&mut self, board: &mut Board, said: &[u8]) {
        for Served { port, end, .. } in &mut self.0 {
            match port {
                PortName::Console => end.write(said),
                PortName::Comms => end.write(&board.comms_read()),
                PortName::Gnss => end.write(&board.gnss_read()),
                PortName::Esp32 => end.write(&board.esp32_read()),
                PortName::Flarm => {}
            }
            let bytes = end.read(board.room(*port));
            match port {
                PortName::Console => {
                    board.chip.bus.usb_host.room = end.has_room();
                    board.console_write(&bytes);
                }
                PortName::Comms => board.comms_write(&bytes),
                PortName::Gnss => board.gnss_write(&bytes),
                PortName::Esp32 => board.esp32_write(&bytes),
                PortName::Flarm => board.flarm_write(&bytes),
            }
        }
    }

    /// Ports with the bytes each has lost.
    pub fn lost(&self) -> impl Iterator<Item = (&'static str, u64)> {
        self.0.iter().map(|s| (s.name, s.end.lost))
    }
}
