//! What is attached to the chip and acts by itself: at instants of true time, through wires.
//!
//! ```text
//!   next_ps() ─ crystal ─ first cycle at or after it ─ act(wires) ─ pin levels, characters for a UART
//! ```
//! A level that changes at an instant is seen by the chip from the first cycle at or after it, behind the input synchroniser as every
//! other level; so PPS reaches PIO, GPIO interrupts and the cores at its exact cycle.

use serde::{Deserialize, Serialize};

use crate::snapshot::Part;
use std::any::Any;

/// Something on the board with a clock of its own.
pub trait Outside: Send + Any {
    /// True time of what it does next, picoseconds since power-on; `None` while it waits for ever.
    fn next_ps(&self) -> Option<u128>;

    /// Does what is due at [`Wires::now_ps`]. Afterwards `next_ps` must lie later.
    fn act(&mut self, wires: &mut Wires);

    /// The UART whose far end it is, if it listens: [`Outside::hear`] gets what the chip sends there.
    fn listens_to(&self) -> Option<usize> {
        None
    }

    /// The chip has sent it these bytes; the last one is complete at this true time.
    fn hear(&mut self, _bytes: &[u8], _now_ps: u128) {}

    /// The board's supply comes (`true`) or goes at this true time.
    fn power(&mut self, on: bool, now_ps: u128);

    /// A copy in the same state, for snapshots.
    fn clone_box(&self) -> Box<dyn Outside>;
    /// For snapshots in a file: itself as a value, if it is one of the twin's parts.
    fn part(&self) -> Option<Part> {
        None
    }
}

/// What something outside can see and do at an instant.
pub struct Wires {
    /// True time, picoseconds since power-on.
    pub now_ps: u128,
    /// Levels of all pads as the board sees them.
    pub levels: u32,
    /// Pins whose levels change, in order.
    pub pins: Vec<(u32, bool)>,
    /// Bytes that begin to arrive at a UART.
    pub bytes: Vec<(usize, Vec<u8>)>,
}

impl Wires {
    pub fn new(now_ps: u128, levels: u32) -> Self {
        Self {
            now_ps,
            levels,
            pins: Vec::new(),
            bytes: Vec::new(),
        }
    }

    /// Drives a pin of the chip.
    pub fn drive(&mut self, pin: u32, level: bool) {
        self.pins.push((pin, level));
    }

    /// Sends bytes to a UART of the chip, the first start bit now.
    pub fn send(&mut self, uart: usize, bytes: &[u8]) {
        self.bytes.push((uart, bytes.to_vec()));
    }
}

/// Everything attached, each with the cycle of its next act.
#[derive(Default, Serialize, Deserialize)]
pub struct Surroundings {
    pub(super) devices: Vec<(Box<dyn Outside>, u64)>,
    /// The first of those cycles.
    pub(super) next: u64,
}

impl Clone for Surroundings {
    fn clone(&self) -> Self {
        let devices = self.devices.iter().map(|(d, at)| (d.clone_box(), *at));
        Self {
            devices: devices.collect(),
            next: self.next,
        }
    }
}

impl Surroundings {
    pub fn new() -> Self {
        Self {
            devices: Vec::new(),
            next: u64::MAX,
        }
    }

    /// The attached device of this kind, the first if there are several.
    pub fn find<T: Outside>(&mut self) -> Option<&mut T> {
        self.devices
            .iter_mut()
            .find_map(|(d, _)| (d.as_mut() as &mut dyn Any).downcast_mut::<T>())
    }
}
