//! The board's serial ends: console, COMMS_UART, the GNSS receiver's place, the ESP32's link, FLARM's input.
//!
//! | port | towards the device | from the device |
//! |---|---|---|
//! | CONSOLE | USB OUT packets as the device takes them | IN packets as long as the host reads |
//! | COMMS_UART, GNSS_UART | at the line's rate, whether it is read or not | the line, whether anyone listens or not |
//! | ESP32 | UART0 while its pins are the ESP32's and its enable is high | the same; otherwise lost |
//! | FLARM | bits on a pin at its own rate | – |
//!
//! Back-pressure: [`Board::room`] says how many bytes a port still takes without more than [`QUEUE`] waiting, so that whoever feeds it
//! from outside can wait and no queue grows without end.

use super::Board;
use super::line_noise::Heard;
use super::pin_serial::PinSerial;
use serde::{Deserialize, Serialize};

/// Bytes that wait for a port at most when its feeder asks for room first.
pub const QUEUE: usize = 4096;
/// Pad function of UART0 on its pins (datasheet 2.19.2).
const FUNCTION_UART: u32 = 2;

/// The ports that have a far end outside the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PortName {
    Console,
    Comms,
    Gnss,
    Esp32,
    Flarm,
}

impl Board {
    /// Bytes that a port takes now.
    pub fn room(&mut self, port: PortName) -> usize {
        let waiting = match port {
            PortName::Console => self.chip.bus.usb_host.to_device.len(),
            PortName::Comms => self.chip.bus.uart[self.kind.comms_uart].far.pending(),
            PortName::Gnss | PortName::Esp32 => self.chip.bus.uart[0].far.pending(),
            PortName::Flarm => self
                .chip
                .bus
                .surroundings
                .find::<PinSerial>()
                .map_or(0, |line| line.waiting()),
        };
        QUEUE.saturating_sub(waiting)
    }

    /// Bytes typed on the console.
    pub fn console_write(&mut self, bytes: &[u8]) {
        self.chip.bus.usb_host.to_device.extend(bytes);
    }

    /// Bytes the console has said since the last call.
    pub fn console_read(&mut self) -> Vec<u8> {
        self.chip.bus.usb_host.from_device.drain(..).collect()
    }

    /// Bytes for the device from the far end of COMMS_UART.
    pub fn comms_write(&mut self, bytes: &[u8]) {
        self.chip.bus.uart_send(self.kind.comms_uart, bytes);
    }

    /// Bytes COMMS_UART has sent since the last call, as they arrive at its far end.
    pub fn comms_read(&mut self) -> Vec<u8> {
        self.uart_read(self.kind.comms_uart)
    }

    /// Bytes for the device from the GNSS receiver's place.
    pub fn gnss_write(&mut self, bytes: &[u8]) {
        self.chip.bus.uart_send(0, bytes);
    }

    /// Bytes GNSS_UART has sent since the last call.
    pub fn gnss_read(&mut self) -> Vec<u8> {
        if self.esp32_linked() {
            return Vec::new();
        }
        self.uart_read(0)
    }

    /// The ESP32's module is on and UART0 is on its pins.
    pub fn esp32_linked(&self) -> bool {
        self.kind.esp32.is_some_and(|nets| {
            let pins = &self.chip.bus.pins;
            pins.function(nets.tx as usize) == FUNCTION_UART && pins.level(nets.enable)
        })
    }

    /// Bytes for the device from the ESP32; lost while it is not linked.
    pub fn esp32_write(&mut self, bytes: &[u8]) {
        if self.esp32_linked() {
            self.chip.bus.uart_send(0, bytes);
        }
    }

    /// Bytes the device has sent to the ESP32 since the last call.
    pub fn esp32_read(&mut self) -> Vec<u8> {
        if self.esp32_linked() {
            self.uart_read(0)
        } else {
            Vec::new()
        }
    }

    /// Bytes of a FLARM on its serial input.
    pub fn flarm_write(&mut self, bytes: &[u8]) {
        let now_ps = self.chip.bus.true_ps();
        if let Some(line) = self.chip.bus.surroundings.find::<PinSerial>() {
            line.send(bytes, now_ps);
            self.chip.bus.time_surroundings();
        }
    }

    fn uart_read(&mut self, uart: usize) -> Vec<u8> {
        let noise = &mut self.noise_from_device[uart];
        let sent = self.chip.bus.uart[uart].sent.drain(..);
        // A far end drops what has no stop bit.
        sent.filter_map(|(_, byte)| match noise.pass(byte) {
            Heard::Byte(byte) => Some(byte),
            Heard::Broken(_) | Heard::Nothing => None,
        })
        .collect()
    }
}
