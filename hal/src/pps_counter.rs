//! GNSS_PPS stamped to one system cycle: PIO0 state machines 2 and 3 count while they wait for its edge.
//!
//! ```text
//!   cycle   0    1    2    3    4    5          state machine 2 tests the pin in even cycles, 3 in odd ones; each counts down X in the other
//!   SM2    test  X--  test  X--  test  X--      cycle of its stamp = 2 (~X) - 2
//!   SM3    X--  test  X--  test  X--  test      cycle of its stamp = 2 (~X) - 3
//!
//!   7 low:  jmp pin 0    ◀── start of SM2             0 rose: jmp x-- 1                              every second instruction counts, on every path:
//!   8       jmp x-- 7    ◀── start of SM3, wraps      1       mov isr, ~x                            X never misses a step, and a jump on X has the
//!                                                     2       jmp x-- 3                              same target whether X was zero or not
//!                                                     3       push noblock
//!                                                     4 high: jmp x-- 5
//!                                                     5       jmp pin 4
//!                                                     6       jmp x-- 7
//! ```
//! The earlier of the two stamps is the cycle in which the pin was high first. They are started by the same write as the sampler of PULSES and pass the same two
//! flip-flops, so both speak of one time: the first sample's cycle is 0.
//!
//! The counts wrap every 2^33 cycles, 71 s: whoever reads them knows the time better than that. A FIFO holds eight stamps; what comes while it is full is lost.

use crate::board::GNSS_PPS_GPIO;
use rp2040_hal::pac;

/// The state machines.
const SM: [usize; 2] = [2, 3];
/// Their bits in CTRL: set by whoever starts the sampler; none on a board without the pin.
pub(crate) const STATE_MACHINES: u8 = if GNSS_PPS_GPIO.is_some() { 0b1100 } else { 0 };
/// First instruction: the sampler has instruction 0 for itself, so the program lies at the end.
const ORIGIN: u16 = 32 - PROGRAM.len() as u16;
/// Source: RP2040 datasheet 3.4 (JMP 000, MOV 101, PUSH 100). Addresses from 0; the origin is added to the jumps.
const PROGRAM: [u16; 9] = [
    JMP_X_DEC | 1,
    MOV_ISR_NOT_X,
    JMP_X_DEC | 3,
    PUSH_NOBLOCK,
    JMP_X_DEC | 5,
    JMP_PIN | 4,
    JMP_X_DEC | 7,
    JMP_PIN,
    JMP_X_DEC | 7,
];
const JMP: u16 = 0x0000;
const JMP_X_DEC: u16 = 0x0040;
const JMP_PIN: u16 = 0x00C0;
const MOV_ISR_NOT_X: u16 = 0xA0C9;
const MOV_X_NOT_NULL: u16 = 0xA02B;
const PUSH_NOBLOCK: u16 = 0x8000;
/// The instruction at which each starts; both wrap from the last to the one before.
const STARTS: [u16; 2] = [7, 8];

/// The reading end.
pub struct PpsCounter(());

fn pio() -> &'static pac::pio0::RegisterBlock {
    // SAFETY: the register block lives as long as the chip; this module touches state machines 2 and 3 and their FIFOs alone.
    unsafe { &*pac::PIO0::ptr() }
}

impl PpsCounter {
    /// Sets both state machines up for `pin`, stopped. PIO0 must be out of reset and its control register untouched.
    pub(crate) fn new(pin: u8) -> Self {
        let pio = pio();
        for (at, &word) in PROGRAM.iter().enumerate() {
            let jump = word & 0xE000 == JMP;
            let word = if jump { word + ORIGIN } else { word };
            // SAFETY: an encoded instruction in a place that is this program's.
            pio.instr_mem(usize::from(ORIGIN) + at)
                .write(|w| unsafe { w.bits(u32::from(word)) });
        }
        let (bottom, top) = ((ORIGIN + STARTS[0]) as u8, (ORIGIN + STARTS[1]) as u8);
        for (sm, start) in SM.into_iter().zip(STARTS) {
            let sm = pio.sm(sm);
            // SAFETY: a divider of 1.0, a pin below 32, a wrap inside the program, instructions that a stopped state machine executes at once.
            unsafe {
                sm.sm_clkdiv().write(|w| w.int().bits(1).frac().bits(0));
                sm.sm_execctrl().write(|w| {
                    w.jmp_pin()
                        .bits(pin)
                        .wrap_top()
                        .bits(top)
                        .wrap_bottom()
                        .bits(bottom)
                });
                sm.sm_shiftctrl().write(|w| w.fjoin_rx().set_bit());
                sm.sm_instr().write(|w| w.bits(u32::from(MOV_X_NOT_NULL)));
                sm.sm_instr()
                    .write(|w| w.bits(u32::from(JMP | (ORIGIN + start))));
            }
        }
        Self(())
    }

    /// The oldest stamp of the state machine that tests in even cycles: its `~X`.
    pub fn take_even(&mut self) -> Option<u32> {
        take(SM[0])
    }

    /// The same of the one that tests in odd cycles.
    pub fn take_odd(&mut self) -> Option<u32> {
        take(SM[1])
    }
}

fn take(sm: usize) -> Option<u32> {
    let empty = pio().fstat().read().rxempty().bits() >> sm & 1 != 0;
    (!empty).then(|| pio().rxf(sm).read().bits())
}
