//! The console's USB port: one CDC ACM function, bytes through a ring of its own.
//!
//! ```text
//!   send(message) ─▶ TX ring 16 KiB ─▶ 64-byte packets ─▶ host       no host that listens (DTR), no room: refused whole
//!   host ─▶ 64-byte packet ─▶ poll(|byte| ..)
//! ```
//! A host that goes away leaves an emptied ring: the next one starts with a whole message (but for at most one packet that was
//! already in the controller). A packet of 64 bytes that ends the stream is followed by an empty one, so that the host delivers it.
//!
//! No serial number string yet: it will be the flash's unique id, and a made-up one would be worse than none. VID and PID are the
//! shared test pair for CDC devices (V-USB's list), to be replaced before anything ships.

use crate::byte_ring::ByteRing;
use rp2040_hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{
    StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid,
};
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

/// Bytes of the transmit ring.
pub const TX_BYTES: usize = 16_384;
/// Bytes of a bulk packet (full speed's largest).
pub const PACKET: usize = 64;

static TX: ByteRing<TX_BYTES> = ByteRing::new();

/// The port.
pub struct UsbConsole {
    device: UsbDevice<'static, UsbBus>,
    class: CdcAcmClass<'static, UsbBus>,
    /// The last packet was full: the host waits for more until a shorter one comes.
    owes_short_packet: bool,
}

impl UsbConsole {
    /// Shows the device to the host. Called once; `None` the second time.
    pub(crate) fn new(bus: UsbBus) -> Option<Self> {
        let allocator =
            cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus))?;
        let class = CdcAcmClass::new(allocator, PACKET as u16);
        let strings = StringDescriptors::default()
            .manufacturer("Squitter")
            .product("Squitter 1090");
        let device = UsbDeviceBuilder::new(allocator, UsbVidPid(0x16C0, 0x27DD))
            .strings(&[strings])
            .ok()?
            .max_packet_size_0(64)
            .ok()?
            .device_class(USB_CLASS_CDC)
            .build();
        Some(Self {
            device,
            class,
            owes_short_packet: false,
        })
    }

    /// Does a host listen: configured, and a program holds the port open?
    pub fn is_open(&self) -> bool {
        self.device.state() == UsbDeviceState::Configured && self.class.dtr()
    }

    /// Bytes that a message may have right now; 0 while nobody listens.
    pub fn free(&self) -> usize {
        if self.is_open() { TX.free() } else { 0 }
    }

    /// Sends the whole message, or refuses it whole.
    pub fn send(&mut self, message: &[u8]) -> bool {
        self.is_open() && TX.offer(message)
    }

    /// Serves the bus and moves one packet each way, each received byte into `received`. Returns whether anything moved: call
    /// again before sleeping if so. A host that types faster than it is answered waits: its next packet is not taken before.
    pub fn poll(&mut self, received: impl FnMut(u8)) -> bool {
        let mut moved = self.device.poll(&mut [&mut self.class]);
        let mut packet = [0; PACKET];
        // Without an event there is nothing to read; a packet that is not taken stays an event.
        if moved && let Ok(count) = self.class.read_packet(&mut packet) {
            packet[..count].iter().copied().for_each(received);
        }
        if self.is_open() {
            moved |= self.send_packet(&mut packet);
        } else {
            TX.consume(TX_BYTES);
            self.owes_short_packet = false;
        }
        moved
    }

    /// One packet, if the controller has room for it.
    fn send_packet(&mut self, packet: &mut [u8; PACKET]) -> bool {
        let count = TX.peek(packet);
        if count == 0 && !self.owes_short_packet {
            return false;
        }
        match self.class.write_packet(&packet[..count]) {
            Ok(written) => {
                TX.consume(written);
                self.owes_short_packet = written == PACKET;
                true
            }
            Err(_) => false,
        }
    }
}
