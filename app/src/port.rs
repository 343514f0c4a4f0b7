//! A port for reports and replies: whole messages or nothing, and what became of them.
//!
//! `offered = sent + dropped`. A message is dropped when it does not fit into the port's buffer or nobody listens: reception never
//! waits for a port.

use hal::uart::CommsUart;
use hal::usb::UsbConsole;

/// What both ports can do with bytes.
pub trait Outlet {
    /// Bytes a message may have right now.
    fn free(&self) -> usize;
    /// Sends the whole message, or refuses it whole.
    fn send(&mut self, message: &[u8]) -> bool;
}

impl Outlet for UsbConsole {
    fn free(&self) -> usize {
        UsbConsole::free(self)
    }
    fn send(&mut self, message: &[u8]) -> bool {
        UsbConsole::send(self, message)
    }
}

impl Outlet for CommsUart {
    fn free(&self) -> usize {
        CommsUart::free(self)
    }
    fn send(&mut self, message: &[u8]) -> bool {
        CommsUart::send(self, message)
    }
}

/// Messages of one port since the start.
#[derive(Clone, Copy, Default)]
pub struct PortCounters {
    /// Messages made for the port.
    pub offered: u32,
    /// Messages that went into its buffer whole.
    pub sent: u32,
    /// Messages that did not.
    pub dropped: u32,
    /// Bytes of the messages sent.
    pub bytes: u32,
}

/// A port and its counters.
pub struct Port<O> {
    pub outlet: O,
    pub counters: PortCounters,
}

impl<O: Outlet> Port<O> {
    /// An unused port.
    pub fn new(outlet: O) -> Self {
        Self {
            outlet,
            counters: PortCounters::default(),
        }
    }

    /// Sends one whole message or counts it dropped.
    pub fn message(&mut self, message: &[u8]) {
        let counters = &mut self.counters;
        counters.offered = counters.offered.wrapping_add(1);
        if self.outlet.send(message) {
            counters.sent = counters.sent.wrapping_add(1);
            counters.bytes = counters.bytes.wrapping_add(message.len() as u32);
        } else {
            counters.dropped = counters.dropped.wrapping_add(1);
        }
    }

    /// Counts messages that were due and could not even be made.
    pub fn dropped_unmade(&mut self, messages: u32) {
        self.counters.offered = self.counters.offered.wrapping_add(messages);
        self.counters.dropped = self.counters.dropped.wrapping_add(messages);
    }
}
