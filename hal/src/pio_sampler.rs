//! PULSES sampled twice by PIO0: at exactly 8 Msps by state machine 0, at 120/7 Msps by state machine 1.
//!
//! ```text
//!   program, one instruction:   in pins, 1      wraps onto itself; both run it
//!   SM0 divider 15.0            120 MHz / 15 = 8 MHz, no fraction: no sample ever jitters
//!   SM1 divider 7.0             120 MHz / 7 = 17.14 MHz, no multiple of the bits' 2 MHz: its samples walk over the edges
//!   shift left, autopush at 32  the oldest sample ends in bit 31; a word every 480 and every 224 cycles
//!   RX FIFOs joined             8 words each, 32 and 15 us of slack for the DMA
//! ```
//! Both start in the same cycle, and the converter right behind them: what they leave in their rings shares one time. State machines 2 and 3 and the last nine
//! instructions are [`crate::pps_counter`]'s, which starts with them.

use crate::level_converter::LevelConverter;
use crate::pps_counter::STATE_MACHINES;
use rp2040_hal::pac;

/// System clock cycles a sample.
pub const CYCLES_PER_SAMPLE: u16 = 15;
/// The same of the second sampler.
pub const CYCLES_PER_ARRIVAL_SAMPLE: u16 = 7;
/// Samples a word.
pub const SAMPLES_PER_WORD: u32 = 32;
/// `in pins, 1` (RP2040 datasheet, 3.4.4: 010 delay 00000, source 000 pins, bit count 00001).
const IN_PINS_1: u16 = 0x4001;
/// Samples a microsecond; together with the word length this gives 4 us a word.
const SAMPLES_PER_US: u32 = crate::SYSTEM_HZ / CYCLES_PER_SAMPLE as u32 / 1_000_000;
/// Microseconds a word.
pub const US_PER_WORD: u32 = SAMPLES_PER_WORD / SAMPLES_PER_US;
const _: () = assert!(US_PER_WORD * SAMPLES_PER_US == SAMPLES_PER_WORD && US_PER_WORD == 4);

/// The sampler, stopped or running.
pub struct PioSampler {
    pio: pac::PIO0,
}

impl PioSampler {
    /// Sets both state machines up for `pin`, stopped. PIO0 must be out of reset.
    pub(crate) fn new(pio: pac::PIO0, pin: u8) -> Self {
        // SAFETY: an encoded instruction; PIO0 is ours alone and stopped.
        pio.instr_mem(0)
            .write(|w| unsafe { w.bits(u32::from(IN_PINS_1)) });
        for (machine, cycles) in [(0, CYCLES_PER_SAMPLE), (1, CYCLES_PER_ARRIVAL_SAMPLE)] {
            let sm = pio.sm(machine);
            // SAFETY: both are valid dividers.
            sm.sm_clkdiv()
                .write(|w| unsafe { w.int().bits(cycles).frac().bits(0) });
            // SAFETY: wrap 0..0 is inside the instruction memory.
            sm.sm_execctrl()
                .write(|w| unsafe { w.wrap_top().bits(0).wrap_bottom().bits(0) });
            // SAFETY: a push threshold of 0 means 32 (datasheet, SM_SHIFTCTRL).
            sm.sm_shiftctrl().write(|w| unsafe {
                w.autopush()
                    .set_bit()
                    .push_thresh()
                    .bits(0)
                    .in_shiftdir()
                    .clear_bit()
                    .fjoin_rx()
                    .set_bit()
            });
            // SAFETY: any pin number below 32 is valid.
            sm.sm_pinctrl().write(|w| unsafe { w.in_base().bits(pin) });
        }
        Self { pio }
    }

    /// Starts sampling, and the converter in the next cycles; the first sample is tick 0.
    ///
    /// Never inlined: it stands in SRAM, so that no cache miss comes between the two.
    #[inline(never)]
    pub fn start(&mut self, converter: &mut LevelConverter) {
        self.clear_overflow();
        const STARTED: u8 = 0b11 | STATE_MACHINES;
        cortex_m::interrupt::free(|_| {
            // SAFETY: starts these state machines, restarts them and their dividers' phase.
            self.pio.ctrl().write(|w| unsafe {
                w.sm_enable()
                    .bits(STARTED)
                    .sm_restart()
                    .bits(STARTED)
                    .clkdiv_restart()
                    .bits(STARTED)
            });
            converter.start();
        });
    }

    /// Did a FIFO ever fill since the last call? Then samples are missing and every later stamp is early.
    #[inline(always)]
    pub fn take_overflow(&mut self) -> bool {
        let stalled = self.pio.fdebug().read().rxstall().bits() & 0b11 != 0;
        if stalled {
            self.clear_overflow();
        }
        stalled
    }

    #[inline(always)]
    fn clear_overflow(&mut self) {
        // SAFETY: write one to clear, the two state machines' bits alone.
        self.pio
            .fdebug()
            .write(|w| unsafe { w.rxstall().bits(0b11) });
    }
}
