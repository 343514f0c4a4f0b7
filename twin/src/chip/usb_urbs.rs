//! Transfers that a driver outside asks the host controller for, instead of the twin's own driver: URBs, as Linux calls them.
//!
//! ```text
//!   own driver: detached → reset → all descriptors → configuration, line coding, DTR → bulk           (`super::usb_host`)
//!   outside:    detached → reset → address, device and configuration descriptors → ready → URBs       (this file, and control transfers there)
//! ```
//! A transfer on a bulk or interrupt endpoint is cut into packets of its endpoint; one to the host ends with a short packet or when it is full (USB 2.0,
//! 5.8.3). Endpoints take turns, a packet each. Control transfers are the host's own, in its queue.
//!
//! Sources: USB 2.0, 5.8, 8.6, 9.4.5; for what a URB is, Linux, Documentation/driver-api/usb/URB.rst.

use std::collections::VecDeque;

use super::usb::{Data, Handshake, Usb};

/// Bytes of a packet of our bulk endpoints; our interrupt endpoint's are shorter, and such a packet ends its transfer.
const PACKET: usize = 64;

/// How a transfer ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    Done,
    /// The device refused it.
    Stalled,
    /// The device did not answer within its time.
    TimedOut,
}

/// A transfer on an endpoint other than 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Urb {
    /// The driver's name for it.
    pub id: u32,
    pub endpoint: usize,
    pub to_host: bool,
    /// Bytes to the device, or those that have come.
    pub data: Vec<u8>,
    /// Bytes wanted, or moved so far to the device.
    pub length: usize,
}

/// A transfer that is over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completed {
    pub id: u32,
    pub ended: Ended,
    /// What came from the device.
    pub data: Vec<u8>,
    /// Bytes moved.
    pub moved: usize,
}

/// The driver's transfers.
#[derive(Clone, Debug, Default)]
pub struct Urbs {
    /// The device has its address and told its descriptors.
    pub ready: bool,
    waiting: VecDeque<Urb>,
    /// PIDs of the next packets, by endpoint: from the device, to it.
    toggles: [[bool; 16]; 2],
    pub completed: VecDeque<Completed>,
}

impl Urbs {
    /// Asks for one.
    pub fn submit(&mut self, urb: Urb) {
        self.waiting.push_back(urb);
    }

    /// Takes one back; false if it is over already.
    pub fn unlink(&mut self, id: u32) -> bool {
        let before = self.waiting.len();
        self.waiting.retain(|urb| urb.id != id);
        self.waiting.len() < before
    }

    /// The device has gone: so have its transfers.
    pub fn detach(&mut self) {
        *self = Self::default();
    }

    /// All endpoints begin with DATA0 (a configuration was set).
    pub fn configured(&mut self) {
        self.toggles = [[false; 16]; 2];
    }

    /// This endpoint, numbered as in a request, goes on from DATA0.
    pub fn halt_cleared(&mut self, endpoint: u8) {
        self.toggles[usize::from(endpoint & 0x80 == 0)][usize::from(endpoint & 0xf)] = false;
    }

    /// A slot of the bus: the next transfer in turn whose endpoint has something moves on by a packet. Whether one did.
    pub fn slot(&mut self, usb: &mut Usb) -> bool {
        for n in 0..self.waiting.len() {
            let urb = &self.waiting[n];
            // Transfers of one endpoint stay in order.
            let is_first =
                |other: &Urb| (other.endpoint, other.to_host) == (urb.endpoint, urb.to_host);
            if self.waiting.iter().take(n).any(is_first) {
                continue;
            }
            let Some(mut urb) = self.waiting.remove(n) else {
                return false;
            };
            let (moved, ended) = self.packet(usb, &mut urb);
            match ended {
                Some(ended) => self.complete(urb, ended),
                // Behind the other endpoints' next ones, before its own.
                None => {
                    let same = |other: &Urb| {
                        (other.endpoint, other.to_host) == (urb.endpoint, urb.to_host)
                    };
                    let at = if moved {
                        let own = self.waiting.iter().position(same);
                        own.unwrap_or(self.waiting.len())
                    } else {
                        n
                    };
                    self.waiting.insert(at, urb);
                }
            }
            if moved {
                return true;
            }
        }
        false
    }

    /// One transaction: whether a packet moved, and how the transfer ended with it.
    fn packet(&mut self, usb: &mut Usb, urb: &mut Urb) -> (bool, Option<Ended>) {
        let toggle = &mut self.toggles[usize::from(!urb.to_host)][urb.endpoint & 0xf];
        if urb.to_host {
            return match usb.token_in(urb.endpoint) {
                // Sent again: acknowledged and dropped.
                Handshake::Data(Data { pid, .. }) if pid != *toggle => (true, None),
                Handshake::Data(Data { bytes, .. }) => {
                    *toggle = !*toggle;
                    urb.data.extend(&bytes);
                    let is_over = bytes.len() < PACKET || urb.data.len() >= urb.length;
                    (true, is_over.then_some(Ended::Done))
                }
                Handshake::Stall => (true, Some(Ended::Stalled)),
                _ => (false, None),
            };
        }
        let end = (urb.length + PACKET).min(urb.data.len());
        let bytes = urb.data[urb.length..end].to_vec();
        match usb.token_out(
            urb.endpoint,
            &Data {
                pid: *toggle,
                bytes,
            },
        ) {
            Handshake::Ack => {
                *toggle = !*toggle;
                urb.length = end;
                (true, (end == urb.data.len()).then_some(Ended::Done))
            }
            Handshake::Stall => (true, Some(Ended::Stalled)),
            _ => (false, None),
        }
    }

    fn complete(&mut self, urb: Urb, ended: Ended) {
        let (data, moved) = if urb.to_host {
            let moved = urb.data.len();
            (urb.data, moved)
        } else {
            (Vec::new(), urb.length)
        };
        self.completed.push_back(Completed {
            id: urb.id,
            ended,
            data,
            moved,
        });
    }
}
