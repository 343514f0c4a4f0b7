//! The console's USB port: one CDC ACM function, bytes through a ring of its own.
//!
//! ```text
//!   send(message) ──▶ ring 16 KiB ─┐
//!                                  ├─▶ 64-byte packets ─▶ host       no host that listens (DTR), no room: refused whole
//!   reply(message) ─▶ ring 8 KiB ──┘
//!   host ─▶ 64-byte packet ─▶ poll(|byte| ..)
//! ```
//! Each message lies behind its length, so that replies can go first and still never stand inside another message: a reply waits for the rest of the
//! message under way, not for the ring. Behind 16 KiB of reports it would come after more than 10 ms.
//!
//! A host that goes away leaves emptied rings: the next one starts with a whole message (but for at most one packet that was
//! already in the controller). A packet of 64 bytes that ends the stream is followed by an empty one, so that the host delivers it.
//!
//! Bootloader and app show the same identity, so that a host gives both the same name: manufacturer, product, and as serial number the flash's
//! unique id in hexadecimal. Tools find a device by these strings: VID and PID are the pair that Raspberry Pi gives for any RP2040 that is a plain
//! CDC serial port (docs/adr/0020).

use crate::byte_ring::ByteRing;
use crate::flash::UNIQUE_ID;
use crate::take_once::TakeOnce;
use crate::usb_packet::{self, PacketBuffer};
use rp2040_hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{
    StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid,
};
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

/// Bytes of the ring of messages, two of each for its length.
pub const TX_BYTES: usize = 16_384;
/// Bytes of the ring of replies.
pub const REPLY_BYTES: usize = 8192;
/// Bytes of a bulk packet (full speed's largest).
pub const PACKET: usize = 64;

/// Vendor and product number: "Pico SDK CDC UART (RP2040)" of <https://github.com/raspberrypi/usb-pid>, which asks devices with a standard
/// class not to take a number of their own, but to tell themselves apart by their strings.
const VID_PID: UsbVidPid = UsbVidPid(0x2E8A, 0x000A);
/// What the host shows, and what tools look for.
const MANUFACTURER: &str = "Squitter";
const PRODUCT: &str = "Squitter 1090";
/// Digits of the serial number: the flash's unique id.
const SERIAL: usize = 2 * UNIQUE_ID;

static MESSAGES: ByteRing<TX_BYTES> = ByteRing::new();
static REPLIES: ByteRing<REPLY_BYTES> = ByteRing::new();
static SERIAL_NUMBER: TakeOnce<[u8; SERIAL]> = TakeOnce::new([b'0'; SERIAL]);

/// The port.
pub struct UsbConsole {
    device: UsbDevice<'static, UsbBus>,
    class: CdcAcmClass<'static, UsbBus>,
    packet: PacketBuffer,
    /// The last packet was full: the host waits for more until a shorter one comes.
    owes_short_packet: bool,
}

impl UsbConsole {
    /// Shows the device to the host. Called once; `None` the second time.
    pub(crate) fn new(bus: UsbBus, unique_id: [u8; UNIQUE_ID]) -> Option<Self> {
        let allocator =
            cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus))?;
        let class = CdcAcmClass::new(allocator, PACKET as u16);
        let strings = StringDescriptors::default()
            .manufacturer(MANUFACTURER)
            .product(PRODUCT)
            .serial_number(hexadecimal(unique_id)?);
        let device = UsbDeviceBuilder::new(allocator, VID_PID)
            .strings(&[strings])
            .ok()?
            .max_packet_size_0(64)
            .ok()?
            .device_class(USB_CLASS_CDC)
            .build();
        Some(Self {
            device,
            class,
            packet: PacketBuffer::new(),
            owes_short_packet: false,
        })
    }

    /// Does a host listen: configured, and a program holds the port open?
    pub fn is_open(&self) -> bool {
        self.device.state() == UsbDeviceState::Configured && self.class.dtr()
    }

    /// Bytes that a message may have right now; 0 while nobody listens.
    pub fn free(&self) -> usize {
        self.free_in(&MESSAGES)
    }

    /// Bytes of messages that wait.
    pub fn waiting(&self) -> usize {
        MESSAGES.len()
    }

    /// Sends the whole message, or refuses it whole.
    pub fn send(&mut self, message: &[u8]) -> bool {
        self.is_open() && usb_packet::offer(&MESSAGES, message)
    }

    /// Bytes that a reply may have right now; 0 while nobody listens.
    pub fn reply_free(&self) -> usize {
        self.free_in(&REPLIES)
    }

    /// Sends a message before those that wait, or refuses it whole.
    pub fn reply(&mut self, message: &[u8]) -> bool {
        self.is_open() && usb_packet::offer(&REPLIES, message)
    }

    fn free_in<const N: usize>(&self, ring: &ByteRing<N>) -> usize {
        if self.is_open() {
            ring.free().saturating_sub(usb_packet::LENGTH_BYTES)
        } else {
            0
        }
    }

    /// Serves the bus and moves one packet each way, each received byte into `received`. Returns whether anything moved: call
    /// again before sleeping if so. A host that types faster than it is answered waits: its next packet is not taken before.
    pub fn poll(&mut self, received: impl FnMut(u8)) -> bool {
        self.serve(true, received)
    }

    /// As [`UsbConsole::poll`], without taking the host's next packet: it waits in the controller, and the host with it.
    pub fn poll_sending(&mut self) -> bool {
        self.serve(false, |_| {})
    }

    fn serve(&mut self, take: bool, received: impl FnMut(u8)) -> bool {
        let mut moved = self.device.poll(&mut [&mut self.class]);
        let mut packet = [0; PACKET];
        // Without an event there is nothing to read; a packet that is not taken stays an event.
        if take
            && moved
            && let Ok(count) = self.class.read_packet(&mut packet)
        {
            packet[..count].iter().copied().for_each(received);
        }
        if self.is_open() {
            moved |= self.send_packet();
        } else {
            MESSAGES.consume(TX_BYTES);
            REPLIES.consume(REPLY_BYTES);
            self.packet = PacketBuffer::new();
            self.owes_short_packet = false;
        }
        moved
    }

    /// One packet, if the controller has room for it.
    fn send_packet(&mut self) -> bool {
        let bytes = self.packet.fill(&REPLIES, &MESSAGES);
        if bytes.is_empty() && !self.owes_short_packet {
            return false;
        }
        match self.class.write_packet(bytes) {
            Ok(written) => {
                self.packet.sent();
                self.owes_short_packet = written == PACKET;
                true
            }
            Err(_) => false,
        }
    }
}

/// The id as the serial number's text, upper case. `None` the second time.
fn hexadecimal(id: [u8; UNIQUE_ID]) -> Option<&'static str> {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    let text = SERIAL_NUMBER.take()?;
    for (pair, byte) in text.chunks_exact_mut(2).zip(id) {
        pair[0] = DIGITS[usize::from(byte >> 4)];
        pair[1] = DIGITS[usize::from(byte & 0xF)];
    }
    core::str::from_utf8(text).ok()
}
