//! COMMS_UART: UART1, 8N1, both ways through byte rings, moved by its interrupt handler on core 0.
//!
//! ```text
//!   send(message) ─▶ TX ring 8 KiB ─▶ FIFO 32 ─▶ line        a message that does not fit is refused whole
//!   line ─▶ FIFO 32 ─▶ RX ring 512 B ─▶ receive()            a byte that does not fit is counted lost
//! ```
//! The handler is the only real one in the firmware: at 3 Mbaud the FIFO lasts 107 us, and half of it after the
//! interrupt: less than core 0's longest job.

use crate::byte_ring::ByteRing;
use core::sync::atomic::{AtomicU32, Ordering};
use rp2040_hal::pac::{self, interrupt};

/// Bytes of the transmit ring: 0.7 s at 115200 baud.
pub const TX_BYTES: usize = 8192;
/// Bytes of the receive ring.
pub const RX_BYTES: usize = 512;
/// Lowest and highest rate, bits a second (the range the AT reference gives).
pub const BAUD_RANGE: core::ops::RangeInclusive<u32> = 9_600..=3_000_000;

static TX: ByteRing<TX_BYTES> = ByteRing::new();
static RX: ByteRing<RX_BYTES> = ByteRing::new();
static RX_LOST: AtomicU32 = AtomicU32::new(0);

/// The port.
pub struct CommsUart {
    baud: u32,
    requested: Option<u32>,
}

fn registers() -> &'static pac::uart0::RegisterBlock {
    // SAFETY: the register block lives as long as the chip; `CommsUart` and its handler, both on core 0, are its only users,
    // and what both touch is touched with the handler masked.
    unsafe { &*pac::UART1::ptr() }
}

impl CommsUart {
    /// Starts the port. UART1 must be out of reset and its pins routed.
    pub(crate) fn new(_uart: pac::UART1, baud: u32) -> Self {
        let mut port = Self {
            baud: 0,
            requested: None,
        };
        port.set_divisor(baud.clamp(*BAUD_RANGE.start(), *BAUD_RANGE.end()));
        registers()
            .uartcr()
            .write(|w| w.uarten().set_bit().txe().set_bit().rxe().set_bit());
        registers()
            .uartimsc()
            .write(|w| w.rxim().set_bit().rtim().set_bit());
        // SAFETY: the handler's rings are statics and ready.
        unsafe { pac::NVIC::unmask(pac::Interrupt::UART1_IRQ) };
        port
    }

    /// The rate the divisor really gives, bits a second.
    pub fn baud(&self) -> u32 {
        self.baud
    }

    /// Asks for another rate; it is set once everything accepted so far has left, and until then nothing more is accepted.
    /// Returns the rate the divisor will really give, or `None` (and no change) out of range.
    pub fn request_baud(&mut self, baud: u32) -> Option<u32> {
        if !BAUD_RANGE.contains(&baud) {
            return None;
        }
        self.requested = Some(baud);
        self.serve();
        Some(4 * crate::SYSTEM_HZ / divisor(baud))
    }

    /// Carries out a requested rate when the line has fallen silent. To be called in the loop.
    pub fn serve(&mut self) {
        let Some(baud) = self.requested else { return };
        if TX.is_empty() && registers().uartfr().read().busy().bit_is_clear() {
            critical_section::with(|_| self.set_divisor(baud));
            self.requested = None;
        }
    }

    /// LCR_H must be written after the divisor for it to take effect, and not while the UART is enabled (PL011).
    fn set_divisor(&mut self, baud: u32) {
        let divisor = divisor(baud);
        let control = registers().uartcr().read().bits();
        registers().uartcr().modify(|_, w| w.uarten().clear_bit());
        // SAFETY: integer part 1..=65535 and fraction 0..=63 are what the registers take.
        registers()
            .uartibrd()
            .write(|w| unsafe { w.bits(divisor / 64) });
        // SAFETY: as above.
        registers()
            .uartfbrd()
            .write(|w| unsafe { w.bits(divisor % 64) });
        // SAFETY: word length code 3 is eight bits.
        registers()
            .uartlcr_h()
            .write(|w| unsafe { w.wlen().bits(3).fen().set_bit() });
        // SAFETY: the register's own value, read above.
        registers().uartcr().write(|w| unsafe { w.bits(control) });
        self.baud = 4 * crate::SYSTEM_HZ / divisor;
    }

    /// Bytes that a message may have right now; 0 while a change of rate waits.
    pub fn free(&self) -> usize {
        if self.requested.is_some() {
            0
        } else {
            TX.free()
        }
    }

    /// Sends the whole message, or refuses it whole.
    pub fn send(&mut self, message: &[u8]) -> bool {
        let accepted = self.requested.is_none() && TX.offer(message);
        critical_section::with(|_| fill_fifo());
        accepted
    }

    /// The oldest byte received.
    pub fn receive(&mut self) -> Option<u8> {
        RX.pop()
    }

    /// Does a byte wait?
    pub fn has_received() -> bool {
        !RX.is_empty()
    }

    /// Bytes lost on the way in since the start: overruns, framing errors and a full ring.
    pub fn received_lost(&self) -> u32 {
        RX_LOST.load(Ordering::Relaxed)
    }
}

/// PL011: the divisor in 64ths is 4 x clock / baud, rounded; 1 to 65535 whole.
fn divisor(baud: u32) -> u32 {
    let divisor = (4 * u64::from(crate::SYSTEM_HZ) + u64::from(baud) / 2) / u64::from(baud);
    divisor.clamp(64, 0xFFFF * 64) as u32
}

/// Moves bytes from the ring to the FIFO; asks for the interrupt only while more wait. The FIFO is full then, so its level will
/// fall through the threshold, which is what raises the line. Runs in the handler, or with it masked.
fn fill_fifo() {
    while registers().uartfr().read().txff().bit_is_clear() {
        let Some(byte) = TX.pop() else { break };
        // SAFETY: the low eight bits are the data.
        registers()
            .uartdr()
            .write(|w| unsafe { w.bits(u32::from(byte)) });
    }
    registers()
        .uartimsc()
        .modify(|_, w| w.txim().bit(!TX.is_empty()));
}

#[interrupt]
fn UART1_IRQ() {
    // RX, TX and receive time-out; the data register's own error bits tell the rest.
    registers().uarticr().write(|w| {
        w.rxic()
            .clear_bit_by_one()
            .txic()
            .clear_bit_by_one()
            .rtic()
            .clear_bit_by_one()
    });
    while registers().uartfr().read().rxfe().bit_is_clear() {
        let word = registers().uartdr().read();
        let damaged = word.fe().bit_is_set() || word.pe().bit_is_set() || word.be().bit_is_set();
        let mut lost = u32::from(word.oe().bit_is_set());
        if damaged || !RX.offer(&[word.data().bits()]) {
            lost += 1;
        }
        RX_LOST.store(
            RX_LOST.load(Ordering::Relaxed).wrapping_add(lost),
            Ordering::Relaxed,
        );
    }
    fill_fifo();
}
