//! Serial ports: 8N1, both ways by DMA, without an interrupt handler.
//!
//! ```text
//!   send(message) ─▶ TX ring ─▶ DMA (paced by the UART) ─▶ FIFO 32 ─▶ line      a message that does not fit is refused whole
//!   line ─▶ FIFO 32 ─▶ DMA (paced by the UART) ─▶ RX ring ─▶ receive()          half-words: the byte and its error marks
//! ```
//! **Out**: a transfer takes what lies in one piece in the ring; `serve`, called in every turn of the loop, starts the next one. The FIFO
//! bridges 107 us between two transfers at 3 Mbaud, and a transfer is as long as what waits, so a loop that is late costs the line a gap, no byte.
//!
//! **In**: the ring is endless as the capture ring is (see [`crate::dma_ring`]): a second channel reloads the count of the first. The count
//! runs over [`ROUND`] characters, so the loop sees by how much it was lapped: what was overwritten is counted lost. Nothing is lost while
//! interrupts are masked or flash is written, as long as the loop comes back within the ring.
//!
//! | port | TX channel | RX channel | its control | DREQ TX, RX |
//! |---|---|---|---|---|
//! | UART1, COMMS_UART | 11 | 10 | 9 | 22, 23 |
//! | UART0 | 8 | 7 | 6 | 20, 21 |
//!
//! Source: RP2040 datasheet 2.5 (DMA), 2.5.3.1 (DREQ numbers), 4.2 (UART); ARM DDI 0183 for the divisors and the marks beside each byte.

use crate::byte_ring::ByteRing;
use core::sync::atomic::{AtomicU16, AtomicU32, Ordering, fence};
use rp2040_hal::pac;

/// Bytes of COMMS_UART's transmit ring: 0.7 s at 115 200 baud.
pub const COMMS_TX_BYTES: usize = 8192;
/// Characters of COMMS_UART's receive ring: 178 ms at 115 200 baud, 6.8 ms at 3 Mbaud. A turn of core 0's loop takes up to 3 ms when all of its code
/// comes from flash for the first time.
pub const COMMS_RX_WORDS: usize = 2048;
/// Bytes of GNSS_UART's transmit ring: a receiver's configuration.
pub const GNSS_TX_BYTES: usize = 256;
/// Characters of GNSS_UART's receive ring: a whole second's sentences, and at 115 200 baud all that comes between two beats of core 0's loop (50 ms).
pub const GNSS_RX_WORDS: usize = 1024;
/// Lowest and highest rate, bits a second (the range the AT reference gives).
pub const BAUD_RANGE: core::ops::RangeInclusive<u32> = 9_600..=3_000_000;

/// Characters that the receiving channel counts before its count is reloaded: 3.5 s at 3 Mbaud, within which the loop must look once.
const ROUND: u32 = 1 << 20;
/// Most bytes of a receive ring, and what each stands aligned to.
const MOST_RX_BYTES: usize = 4096;

/// What the control channel writes into the receiving channel's count. In SRAM: a DMA read from XIP would stall while flash is erased.
static ROUND_RELOAD: AtomicU32 = AtomicU32::new(ROUND);

/// A UART and what belongs to it.
pub struct Wiring {
    registers: *const pac::uart0::RegisterBlock,
    tx_dreq: u32,
    rx_dreq: u32,
    tx_channel: usize,
    rx_channel: usize,
    rx_control: usize,
}

// SAFETY: the address of registers, which live as long as the chip; `Uart`, which exists once a UART, is their only user.
unsafe impl Sync for Wiring {}

/// UART0.
pub static UART0: Wiring = Wiring {
    registers: pac::UART0::ptr(),
    tx_dreq: 20,
    rx_dreq: 21,
    tx_channel: 8,
    rx_channel: 7,
    rx_control: 6,
};
/// UART1.
pub static UART1: Wiring = Wiring {
    registers: pac::UART1::ptr(),
    tx_dreq: 22,
    rx_dreq: 23,
    tx_channel: 11,
    rx_channel: 10,
    rx_control: 9,
};

/// A receive ring, in a static that is aligned to its size; `N` is a power of two, at most 2048. No cell is read before a character has landed in it: the
/// memory may hold anything at first.
pub struct Received<const N: usize>([AtomicU16; N]);

/// COMMS_UART's, aligned.
#[repr(align(4096))]
struct CommsReceived(Received<COMMS_RX_WORDS>);
/// GNSS_UART's, aligned.
#[repr(align(2048))]
struct GnssReceived(Received<GNSS_RX_WORDS>);
const _: () = assert!(2 * COMMS_RX_WORDS == 4096 && 2 * GNSS_RX_WORDS == 2048);

impl<const N: usize> Received<N> {
    /// A ring.
    pub const fn new() -> Self {
        const { assert!(N.is_power_of_two() && 2 * N <= MOST_RX_BYTES && N >= 2) };
        Self([const { AtomicU16::new(0) }; N])
    }
}

impl<const N: usize> Default for Received<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Alone in its bank of SRAM (`linker/app.x`).
#[unsafe(link_section = ".comms_received")]
static COMMS_RECEIVED: CommsReceived = CommsReceived(Received::new());
static COMMS_TO_SEND: ByteRing<COMMS_TX_BYTES> = ByteRing::new();

static GNSS_RECEIVED: GnssReceived = GnssReceived(Received::new());
static GNSS_TO_SEND: ByteRing<GNSS_TX_BYTES> = ByteRing::new();

/// GNSS_UART.
pub type GnssUart = Uart<GNSS_TX_BYTES, GNSS_RX_WORDS>;

impl GnssUart {
    /// Starts GNSS_UART on UART0.
    pub(crate) fn gnss(_uart: pac::UART0, baud: u32) -> Self {
        Self::start(&UART0, &GNSS_TO_SEND, &GNSS_RECEIVED.0, baud)
    }
}

/// COMMS_UART.
pub type CommsUart = Uart<COMMS_TX_BYTES, COMMS_RX_WORDS>;

impl CommsUart {
    /// Starts COMMS_UART on UART1.
    pub(crate) fn comms(_uart: pac::UART1, baud: u32) -> Self {
        Self::start(&UART1, &COMMS_TO_SEND, &COMMS_RECEIVED.0, baud)
    }
}

/// A port.
pub struct Uart<const TX: usize, const RX: usize> {
    wiring: &'static Wiring,
    to_send: &'static ByteRing<TX>,
    received: &'static Received<RX>,
    baud: u32,
    requested: Option<u32>,
    /// Bytes of the transfer under way that still stand in the ring.
    sending: usize,
    /// Characters taken from the receive ring, modulo [`ROUND`].
    taken: u32,
    /// Characters known to have come in, likewise: up to here they may be taken without looking again.
    known: u32,
    received_lost: u32,
}

fn dma() -> &'static pac::dma::RegisterBlock {
    // SAFETY: the register block lives as long as the chip; this module touches the channels of its table and their bits alone.
    unsafe { &*pac::DMA::ptr() }
}

impl<const TX: usize, const RX: usize> Uart<TX, RX> {
    /// Starts a port; called once for a wiring. Its UART and DMA must be out of reset and its pins routed.
    pub(crate) fn start(
        wiring: &'static Wiring,
        to_send: &'static ByteRing<TX>,
        received: &'static Received<RX>,
        baud: u32,
    ) -> Self {
        let mut port = Self {
            wiring,
            to_send,
            received,
            baud: 0,
            requested: None,
            sending: 0,
            taken: 0,
            known: 0,
            received_lost: 0,
        };
        port.arm_receive();
        port.arm_transmit();
        port.set_divisor(baud.clamp(*BAUD_RANGE.start(), *BAUD_RANGE.end()));
        let registers = port.registers();
        registers
            .uartdmacr()
            .write(|w| w.txdmae().set_bit().rxdmae().set_bit());
        registers
            .uartcr()
            .write(|w| w.uarten().set_bit().txe().set_bit().rxe().set_bit());
        port
    }

    fn registers(&self) -> &'static pac::uart0::RegisterBlock {
        // SAFETY: see `Wiring`.
        unsafe { &*self.wiring.registers }
    }

    /// Both receiving channels: from now on each character lands in the ring.
    fn arm_receive(&self) {
        let wiring = self.wiring;
        let (data, control) = (dma().ch(wiring.rx_channel), dma().ch(wiring.rx_control));
        let source = self.registers().uartdr().as_ptr() as u32;
        let target = self.received.0.as_ptr() as u32;
        // SAFETY: the source is a FIFO register, the target a static ring whose address bits above its size never change (RING_SIZE; it
        // stands on a multiple of its size); its cells are atomics, so the hardware's writes are no data race.
        unsafe {
            data.ch_read_addr().write(|w| w.bits(source));
            data.ch_write_addr().write(|w| w.bits(target));
            data.ch_trans_count().write(|w| w.bits(ROUND));
            data.ch_al1_ctrl().write(|w| {
                w.bits(
                    ctrl::ENABLE
                        | ctrl::HALF_WORDS
                        | ctrl::INCREMENT_WRITE
                        | ctrl::write_ring(2 * RX as u32)
                        | ctrl::chain_to(wiring.rx_control)
                        | ctrl::paced_by(wiring.rx_dreq),
                )
            });
            let reload = ROUND_RELOAD.as_ptr() as u32;
            control.ch_read_addr().write(|w| w.bits(reload));
            let count = data.ch_al1_trans_count_trig().as_ptr() as u32;
            control.ch_write_addr().write(|w| w.bits(count));
            control.ch_trans_count().write(|w| w.bits(1));
            control.ch_al1_ctrl().write(|w| {
                w.bits(
                    ctrl::ENABLE
                        | ctrl::WORDS
                        | ctrl::chain_to(wiring.rx_control)
                        | ctrl::paced_by(ctrl::UNPACED)
                        | ctrl::QUIET,
                )
            });
            let trigger = 1 << wiring.rx_channel;
            dma().multi_chan_trigger().write(|w| w.bits(trigger));
        }
    }

    /// The sending channel, idle; its end wakes core 0 (DMA_IRQ_0, see [`crate::sleep`]).
    fn arm_transmit(&self) {
        let channel = dma().ch(self.wiring.tx_channel);
        let target = self.registers().uartdr().as_ptr() as u32;
        // SAFETY: the target is a FIFO register; the source is set before each transfer.
        unsafe {
            channel.ch_write_addr().write(|w| w.bits(target));
            channel.ch_al1_ctrl().write(|w| {
                w.bits(
                    ctrl::ENABLE
                        | ctrl::INCREMENT_READ
                        | ctrl::chain_to(self.wiring.tx_channel)
                        | ctrl::paced_by(self.wiring.tx_dreq),
                )
            });
            let bit = 1 << self.wiring.tx_channel;
            dma().inte0().modify(|r, w| w.bits(r.bits() | bit));
        }
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

    /// Goes on sending; carries out a requested rate when the line has fallen silent. To be called in the loop.
    pub fn serve(&mut self) {
        self.go_on_sending();
        // What is known grows old between two turns: the ring may have been lapped.
        self.known = self.taken;
        let Some(baud) = self.requested else { return };
        if self.to_send.is_empty() && self.registers().uartfr().read().busy().bit_is_clear() {
            self.set_divisor(baud);
            self.requested = None;
        }
    }

    /// Frees what has left the ring, and starts the next transfer when the last one is over.
    fn go_on_sending(&mut self) {
        let channel = dma().ch(self.wiring.tx_channel);
        let is_busy = channel.ch_ctrl_trig().read().busy().bit_is_set();
        let left = channel.ch_trans_count().read().bits() as usize;
        // The last byte is the channel's until it says so.
        let left = if is_busy { left.max(1) } else { 0 }.min(self.sending);
        self.to_send.consume(self.sending - left);
        self.sending = left;
        if is_busy {
            return;
        }
        // SAFETY: write one to clear, this channel's bit alone: its line must fall before core 0 sleeps.
        dma()
            .ints0()
            .write(|w| unsafe { w.bits(1 << self.wiring.tx_channel) });
        let next = self.to_send.front();
        if next.is_empty() {
            return;
        }
        self.sending = next.len();
        // The bytes are in memory before the channel reads them.
        fence(Ordering::SeqCst);
        // SAFETY: the source is a part of a static ring that nobody writes to until it is consumed, which happens above alone.
        unsafe {
            let source = next.as_ptr() as u32;
            channel.ch_read_addr().write(|w| w.bits(source));
            let count = next.len() as u32;
            channel.ch_al1_trans_count_trig().write(|w| w.bits(count));
        }
    }

    /// LCR_H must be written after the divisor for it to take effect, and not while the UART is enabled (PL011).
    fn set_divisor(&mut self, baud: u32) {
        let divisor = divisor(baud);
        let registers = self.registers();
        let control = registers.uartcr().read().bits();
        registers.uartcr().modify(|_, w| w.uarten().clear_bit());
        // SAFETY: integer part 1..=65535 and fraction 0..=63 are what the registers take; 3 is the code of eight bits; the control register
        // gets its own value back.
        unsafe {
            registers.uartibrd().write(|w| w.bits(divisor / 64));
            registers.uartfbrd().write(|w| w.bits(divisor % 64));
            registers
                .uartlcr_h()
                .write(|w| w.wlen().bits(3).fen().set_bit());
            registers.uartcr().write(|w| w.bits(control));
        }
        self.baud = 4 * crate::SYSTEM_HZ / divisor;
    }

    /// Bytes that a message may have right now; 0 while a change of rate waits.
    pub fn free(&self) -> usize {
        if self.requested.is_some() {
            0
        } else {
            self.to_send.free()
        }
    }

    /// Bytes that were accepted and have not left the ring.
    pub fn waiting(&self) -> usize {
        self.to_send.len()
    }

    /// Sends the whole message, or refuses it whole.
    pub fn send(&mut self, message: &[u8]) -> bool {
        let accepted = self.requested.is_none() && self.to_send.offer(message);
        self.go_on_sending();
        accepted
    }

    /// Has everything accepted left the port, down to the last stop bit?
    pub fn is_silent(&self) -> bool {
        self.to_send.is_empty() && self.registers().uartfr().read().busy().bit_is_clear()
    }

    /// Characters that came in so far, modulo [`ROUND`].
    fn came_in(&self) -> u32 {
        let left = dma().ch(self.wiring.rx_channel).ch_trans_count().read();
        ROUND.wrapping_sub(left.bits()) % ROUND
    }

    /// Does a byte wait?
    pub fn has_received(&self) -> bool {
        self.came_in() != self.taken
    }

    /// The oldest byte received. Damaged characters (framing, parity, break) are passed over and counted.
    pub fn receive(&mut self) -> Option<u8> {
        loop {
            if self.known == self.taken && !self.look() {
                return None;
            }
            let word = self.received.0[self.taken as usize & (RX - 1)].load(Ordering::Relaxed);
            self.taken = (self.taken + 1) % ROUND;
            let lost = u32::from(word & mark::OVERRUN != 0);
            let damaged = word & mark::DAMAGED != 0;
            self.received_lost = self.received_lost.wrapping_add(lost + u32::from(damaged));
            if !damaged {
                return Some(word as u8);
            }
        }
    }

    /// Looks at what came in. Returns whether anything did.
    fn look(&mut self) -> bool {
        self.known = self.came_in();
        let waiting = self.known.wrapping_sub(self.taken) % ROUND;
        if waiting == 0 {
            return false;
        }
        if waiting as usize > RX {
            // Lapped: what is left of the older half may be overwritten while it is read.
            let skipped = waiting - RX as u32 / 2;
            self.taken = self.taken.wrapping_add(skipped) % ROUND;
            self.received_lost = self.received_lost.wrapping_add(skipped);
        }
        // The count moves when a transfer is issued. A read through the same bridge ends after the channel's own, and the channel's write
        // follows within two cycles.
        let _ = self.registers().uartfr().read();
        fence(Ordering::Acquire);
        true
    }

    /// Characters lost on the way in since the start: damaged, overrun, or not fetched in time.
    pub fn received_lost(&self) -> u32 {
        self.received_lost
    }
}

/// The rate a divisor gives for this one, bits a second.
pub fn actual_baud(baud: u32) -> u32 {
    4 * crate::SYSTEM_HZ / divisor(baud)
}

/// PL011: the divisor in 64ths is 4 x clock / baud, rounded; 1 to 65535 whole.
fn divisor(baud: u32) -> u32 {
    let divisor = (4 * u64::from(crate::SYSTEM_HZ) + u64::from(baud) / 2) / u64::from(baud);
    divisor.clamp(64, 0xFFFF * 64) as u32
}

/// Marks beside a byte in UARTDR.
mod mark {
    /// Framing error, parity error, break.
    pub const DAMAGED: u16 = 1 << 8 | 1 << 9 | 1 << 10;
    /// The FIFO was full: at least one character before this one is missing.
    pub const OVERRUN: u16 = 1 << 11;
}

/// Fields of a channel's CTRL register (RP2040 datasheet, 2.5.7: CH0_CTRL_TRIG).
mod ctrl {
    pub const ENABLE: u32 = 1;
    pub const HALF_WORDS: u32 = 1 << 2;
    pub const WORDS: u32 = 2 << 2;
    pub const INCREMENT_READ: u32 = 1 << 4;
    pub const INCREMENT_WRITE: u32 = 1 << 5;
    pub const QUIET: u32 = 1 << 21;
    /// TREQ "permanent": as fast as possible.
    pub const UNPACED: u32 = 0x3F;

    /// Write addresses wrap within so many bytes.
    pub const fn write_ring(bytes: u32) -> u32 {
        bytes.trailing_zeros() << 6 | 1 << 10
    }

    /// The channel that is triggered at the end; itself: none.
    pub const fn chain_to(channel: usize) -> u32 {
        (channel as u32) << 11
    }

    pub const fn paced_by(dreq: u32) -> u32 {
        dreq << 15
    }
}
