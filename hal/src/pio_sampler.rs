//! PULSES sampled at exactly 8 Msps by PIO0 state machine 0.
//!
//! ```text
//!   program, one instruction:   in pins, 1      wraps onto itself
//!   clock divider 15.0          120 MHz / 15 = 8 MHz, no fraction: no sample ever jitters
//!   shift left, autopush at 32  the oldest sample ends in bit 31; a word every 4 us = 480 cycles
//!   RX FIFO joined              8 words = 32 us of slack for the DMA
//! ```
//! State machine 1 stays free for the later 120/7 MHz arrival sampler; 2 and 3 and the last nine instructions are [`crate::pps_counter`]'s, which starts with
//! this one.

use crate::pps_counter::STATE_MACHINES;
use rp2040_hal::pac;

/// System clock cycles a sample.
pub const CYCLES_PER_SAMPLE: u16 = 15;
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
    /// Sets state machine 0 up for `pin`, stopped. PIO0 must be out of reset.
    pub(crate) fn new(pio: pac::PIO0, pin: u8) -> Self {
        // SAFETY: an encoded instruction; PIO0 is ours alone and stopped.
        pio.instr_mem(0)
            .write(|w| unsafe { w.bits(u32::from(IN_PINS_1)) });
        let sm = pio.sm(0);
        // SAFETY: 15.0 is a valid divider.
        sm.sm_clkdiv()
            .write(|w| unsafe { w.int().bits(CYCLES_PER_SAMPLE).frac().bits(0) });
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
        Self { pio }
    }

    /// Starts sampling, and the counters of PPS in the same cycle; the first sample is tick 0.
    pub fn start(&mut self) {
        self.clear_overflow();
        const STARTED: u8 = 1 | STATE_MACHINES;
        // SAFETY: starts these state machines, restarts them and their dividers' phase, leaves the other one stopped.
        self.pio.ctrl().write(|w| unsafe {
            w.sm_enable()
                .bits(STARTED)
                .sm_restart()
                .bits(STARTED)
                .clkdiv_restart()
                .bits(STARTED)
        });
    }

    /// Did the FIFO ever fill since the last call? Then samples are missing and every later stamp is early.
    #[inline(always)]
    pub fn take_overflow(&mut self) -> bool {
        let stalled = self.pio.fdebug().read().rxstall().bits() & 1 != 0;
        if stalled {
            self.clear_overflow();
        }
        stalled
    }

    #[inline(always)]
    fn clear_overflow(&mut self) {
        // SAFETY: write one to clear, state machine 0's bit alone.
        self.pio.fdebug().write(|w| unsafe { w.rxstall().bits(1) });
    }
}
