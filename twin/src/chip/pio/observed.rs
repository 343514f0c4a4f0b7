//! What a state machine holds inside, for comparison with other emulators. An instrument: the chip has no registers for most of it,
//! and nothing in the twin depends on it.

use super::Pio;
use serde::{Deserialize, Serialize};

/// The inside of one state machine after a cycle.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Observed {
    /// Address of the next instruction, 0 to 31.
    pub pc: u32,
    pub x: u32,
    pub y: u32,
    pub isr: u32,
    /// Bits shifted in, 0 to 32.
    pub isr_count: u32,
    pub osr: u32,
    /// Bits shifted out, 0 (full) to 32 (empty).
    pub osr_count: u32,
    /// Delay cycles left before the next instruction.
    pub delay: u32,
    /// Words in the FIFOs, the oldest first.
    pub tx: Vec<u32>,
    pub rx: Vec<u32>,
}

impl Pio {
    /// Looks into state machine `n`; changes nothing.
    pub fn observe(&self, n: usize) -> Observed {
        let sm = &self.sm[n];
        Observed {
            pc: sm.pc,
            x: sm.x,
            y: sm.y,
            isr: sm.isr,
            isr_count: sm.isr_count,
            osr: sm.osr,
            osr_count: sm.osr_count,
            delay: sm.delay,
            tx: sm.tx.to_vec(),
            rx: sm.rx.to_vec(),
        }
    }
}
