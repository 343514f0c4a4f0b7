//! Rings in SRAM that DMA fills for ever.
//!
//! The chip's DMA has no endless mode: a count of 2^32 words at 4 us is 4.8 hours, and then silence. So the end of the count is
//! made the ordinary case:
//!
//! ```text
//!   channel 0 (data)      PIO0 RX0 ─▶ ring, write address wraps in hardware, 32 words (128 us), raises DMA_IRQ_1
//!        │ chain                                                   ▲
//!        ▼                                                         │ trigger
//!   channel 1 (control)   one word, 32 ─▶ channel 0's AL1_TRANS_COUNT_TRIG
//! ```
//! | stream | channels | from | words | a word every |
//! |---|---|---|---|---|
//! | samples | 0, 1 | PIO0 RX0 | 2048 | 4 µs; its blocks raise DMA_IRQ_1 |
//! | arrival | 2, 3 | PIO0 RX1 | 4096 | 1.867 µs |
//! | level | 4, 5 | ADC FIFO | 2048 | 2.271 µs |
//!
//! The write address is never rewritten, so it stays the one truth of how far the ring is. Between two blocks the PIO's FIFO
//! holds the samples: the chain takes tens of cycles, the FIFO lasts 3 840.

use core::sync::atomic::{AtomicU32, Ordering, fence};
use rp2040_hal::pac;

/// Words a block: one interrupt every 128 us at 4 us a word.
pub const BLOCK_WORDS: u32 = 32;
/// Data channel of the samples: its blocks wake core 1.
const DATA: usize = 0;
/// TREQ of PIO0's RX FIFOs 0 and 1, and of the ADC's FIFO (RP2040 datasheet, 2.5.3.1).
const TREQ_PIO0_RX0: u8 = 4;
const TREQ_PIO0_RX1: u8 = 5;
const TREQ_ADC: u8 = 36;
/// TREQ "permanent": as fast as possible.
const TREQ_PERMANENT: u8 = 0x3F;

/// What the control channel writes into the data channel's count. In SRAM, because a DMA read from XIP would stall while flash is erased.
static BLOCK_RELOAD: AtomicU32 = AtomicU32::new(BLOCK_WORDS);

/// The running ring of samples, `N` words.
pub struct DmaRing<const N: usize> {
    dma: pac::DMA,
    base: u32,
}

/// The ring's memory does not stand on a multiple of its own size, or its size is no power of two from 2 to 2^13 words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Misplaced;

/// The DMA channels before they have rings.
pub struct DmaChannels {
    pub(crate) dma: pac::DMA,
}

/// Where a stream comes from and the first of its two channels.
struct Stream {
    data: usize,
    treq: u8,
    source: u32,
}

impl<const N: usize> DmaRing<N> {
    /// Points the channels at the rings and arms them: each word that a sampler or the converter pushes from now on lands in its ring.
    pub fn arm<const A: usize, const L: usize>(
        channels: DmaChannels,
        samples: &'static [AtomicU32; N],
        arrival: &'static [AtomicU32; A],
        level: &'static [AtomicU32; L],
    ) -> Result<Self, Misplaced> {
        let dma = channels.dma;
        // SAFETY: the registers' addresses alone are taken.
        let [rx0, rx1, adc] = unsafe {
            let (pio, adc) = (&*pac::PIO0::ptr(), &*pac::ADC::ptr());
            [
                pio.rxf(0).as_ptr(),
                pio.rxf(1).as_ptr(),
                adc.fifo().as_ptr(),
            ]
        }
        .map(|register| register as u32);
        let stream = |data, treq, source| Stream { data, treq, source };
        arm(&dma, stream(DATA, TREQ_PIO0_RX0, rx0), samples)?;
        arm(&dma, stream(2, TREQ_PIO0_RX1, rx1), arrival)?;
        arm(&dma, stream(4, TREQ_ADC, adc), level)?;
        // SAFETY: every set of channels is valid for both.
        unsafe {
            dma.inte1().write(|w| w.bits(1 << DATA));
            dma.multi_chan_trigger().write(|w| w.bits(0b01_0101));
        }
        Ok(Self {
            dma,
            base: samples.as_ptr() as u32,
        })
    }

    /// Index of the word that will be written next. The address moves when a transfer is issued: the newest word may land a few
    /// cycles after this was read, while the sampler needs 480 for the next one.
    #[inline(always)]
    pub fn position(&self) -> u32 {
        let address = self.dma.ch(DATA).ch_write_addr().read().bits();
        // No word of the ring is read before the address that says it is there.
        fence(Ordering::Acquire);
        (address.wrapping_sub(self.base) / 4) & (N as u32 - 1)
    }

    /// Enables the block interrupt as a wake-up of the calling core, which keeps its interrupts masked.
    #[inline(always)]
    pub fn wake_this_core(&self) {
        // SAFETY: no handler runs, because the caller's interrupts are masked; the line only ends WFI.
        unsafe { pac::NVIC::unmask(pac::Interrupt::DMA_IRQ_1) };
    }

    /// Sleeps until a block has completed, and takes its interrupt back. A block that completed before the call returns at once.
    #[inline(always)]
    pub fn wait_block(&mut self) {
        while self.dma.ints1().read().bits() & 1 << DATA == 0 {
            pac::NVIC::unpend(pac::Interrupt::DMA_IRQ_1);
            // The line is a level: if the block ended between the read and here, it is pending again and WFI falls through.
            if self.dma.ints1().read().bits() & 1 << DATA == 0 {
                cortex_m::asm::wfi();
            }
        }
        // SAFETY: write one to clear, the data channel's bit alone.
        self.dma.ints1().write(|w| unsafe { w.bits(1 << DATA) });
        pac::NVIC::unpend(pac::Interrupt::DMA_IRQ_1);
    }
}

/// Sets up one ring's two channels, not yet triggered.
fn arm<const N: usize>(
    dma: &pac::DMA,
    stream: Stream,
    words: &'static [AtomicU32; N],
) -> Result<(), Misplaced> {
    let base = words.as_ptr() as u32;
    let bytes = (N * 4) as u32;
    if !N.is_power_of_two() || !(8..=1 << 15).contains(&bytes) || base & (bytes - 1) != 0 {
        return Err(Misplaced);
    }
    let control_number = stream.data + 1;
    // SAFETY: the source is a FIFO register, the target a static ring whose address bits above its size never change
    // (RING_SIZE, alignment checked above); the words are atomics, so the hardware's writes are no data race.
    unsafe {
        let data = dma.ch(stream.data);
        data.ch_read_addr().write(|w| w.bits(stream.source));
        data.ch_write_addr().write(|w| w.bits(base));
        data.ch_trans_count().write(|w| w.bits(BLOCK_WORDS));
        data.ch_al1_ctrl().write(|w| {
            w.bits(ctrl(|c| {
                c.incr_write = true;
                c.ring_size_write = bytes.trailing_zeros();
                c.treq = stream.treq;
                c.chain_to = control_number as u32;
                c.high_priority = true;
            }))
        });
        let control = dma.ch(control_number);
        control
            .ch_read_addr()
            .write(|w| w.bits(BLOCK_RELOAD.as_ptr() as u32));
        control
            .ch_write_addr()
            .write(|w| w.bits(data.ch_al1_trans_count_trig().as_ptr() as u32));
        control.ch_trans_count().write(|w| w.bits(1));
        control.ch_al1_ctrl().write(|w| {
            w.bits(ctrl(|c| {
                c.treq = TREQ_PERMANENT;
                c.chain_to = control_number as u32;
                c.high_priority = true;
                c.irq_quiet = true;
            }))
        });
    }
    Ok(())
}

/// Fields of a channel's CTRL register (RP2040 datasheet, 2.5.7: CH0_CTRL_TRIG).
#[derive(Default)]
struct Ctrl {
    high_priority: bool,
    incr_write: bool,
    /// log2 of the ring in bytes, applied to write addresses; 0 = no ring.
    ring_size_write: u32,
    chain_to: u32,
    treq: u8,
    irq_quiet: bool,
}

fn ctrl(set: impl FnOnce(&mut Ctrl)) -> u32 {
    let mut fields = Ctrl::default();
    set(&mut fields);
    const ENABLE: u32 = 1;
    const SIZE_WORD: u32 = 2 << 2;
    const RING_SEL_WRITE: u32 = 1 << 10;
    let ring = if fields.ring_size_write == 0 {
        0
    } else {
        fields.ring_size_write << 6 | RING_SEL_WRITE
    };
    ENABLE
        | SIZE_WORD
        | u32::from(fields.high_priority) << 1
        | u32::from(fields.incr_write) << 5
        | ring
        | fields.chain_to << 11
        | u32::from(fields.treq) << 15
        | u32::from(fields.irq_quiet) << 21
}
