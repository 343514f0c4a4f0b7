//! Both ports as the reporters see them.

use hal::uart::CommsUart;
use hal::usb::UsbConsole;
use reporter::Outlet;

/// CONSOLE: replies have a queue of their own.
pub struct Console(pub UsbConsole);

impl Outlet for Console {
    fn free(&self) -> usize {
        self.0.free()
    }
    fn waiting(&self) -> usize {
        self.0.waiting()
    }
    fn send(&mut self, message: &[u8]) -> bool {
        self.0.send(message)
    }
    fn reply_free(&self) -> usize {
        self.0.reply_free()
    }
    fn reply(&mut self, message: &[u8]) -> bool {
        self.0.reply(message)
    }
}

/// COMMS_UART: replies wait in line.
pub struct Comms(pub CommsUart);

impl Outlet for Comms {
    fn free(&self) -> usize {
        self.0.free()
    }
    fn waiting(&self) -> usize {
        self.0.waiting()
    }
    fn send(&mut self, message: &[u8]) -> bool {
        self.0.send(message)
    }
    fn reply_free(&self) -> usize {
        self.0.free()
    }
    fn reply(&mut self, message: &[u8]) -> bool {
        self.0.send(message)
    }
}
