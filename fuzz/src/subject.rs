//! What is fuzzed, and what must hold after every step.

use crate::Step;
use crate::state;
use mode_s::{Frame, Impossible, Message, ModeACode, infer, possible};
use tracker::{Counters, Heard, TIMEOUT_MS, Tracker};

/// Places of the tracker: few, so that it is mostly full.
const PLACES: usize = 32;
/// Steps between two looks at every aircraft.
const LOOK_EVERY: u64 = 1_024;

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// A field of a message or of an aircraft.
    Value {
        /// What.
        field: &'static str,
        /// Its value.
        value: i64,
    },
    /// A sum of counters.
    Sum(Box<Counters>),
    /// An aircraft that should have ended.
    Immortal,
}

impl From<Impossible> for Wrong {
    fn from(found: Impossible) -> Wrong {
        Wrong::Value {
            field: found.field,
            value: found.value.into(),
        }
    }
}

/// Decoder and tracker.
pub struct Subject {
    tracker: Box<Tracker<PLACES>>,
    steps: u64,
    frames: u64,
    registers: u64,
}

impl Subject {
    /// Nothing heard.
    pub fn new() -> Subject {
        Subject {
            tracker: Box::new(Tracker::new()),
            steps: 0,
            frames: 0,
            registers: 0,
        }
    }

    /// Frames taken.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Comm-B registers that were found.
    pub fn registers_found(&self) -> u64 {
        self.registers
    }

    /// The tracker's counters.
    pub fn counters(&self) -> Counters {
        self.tracker.counters()
    }

    /// Takes a step.
    pub fn take(&mut self, at_ms: u64, step: &Step) -> Result<(), Wrong> {
        self.steps += 1;
        match step {
            Step::Bytes(bytes) => self.hear(at_ms, bytes)?,
            Step::ModeAc(bits) => self.tracker.on_mode_ac(ModeACode(bits & 0xFFF)),
            Step::Second => {
                self.tracker.each_second(at_ms);
                if self
                    .tracker
                    .aircraft()
                    .any(|one| one.silent_ms(at_ms) > TIMEOUT_MS)
                {
                    return Err(Wrong::Immortal);
                }
            }
            Step::Rx(rx) => self.tracker.set_rx_position(*rx),
        }
        if self.steps.is_multiple_of(LOOK_EVERY) {
            for aircraft in self.tracker.aircraft() {
                state::possible(aircraft, at_ms)?;
            }
            self.sums()?;
        }
        Ok(())
    }

    fn hear(&mut self, at_ms: u64, bytes: &[u8]) -> Result<(), Wrong> {
        let Ok(frame) = Frame::from_bytes(bytes) else {
            return Ok(());
        };
        self.frames += 1;
        let message = Message::decode(&frame);
        possible(&message)?;
        let address = message.address();
        let before = address.and_then(|address| self.tracker.find(address));
        if let (Some(mb), Some(aircraft)) = (message.mb(), before) {
            self.registers += u64::from(infer(mb, &aircraft.known(at_ms)).found().is_some());
        }
        let heard = Heard {
            level_cdbm: Some(-(at_ms as i16 & 0x1FFF) - 1),
            quality_cdb: Some(at_ms as i16 & 0xFFF),
            is_repaired: at_ms.is_multiple_of(5),
            ..Heard::at(at_ms)
        };
        self.tracker.on_frame(&frame, &message, heard);
        if let Some(aircraft) = address.and_then(|address| self.tracker.find(address)) {
            state::possible(aircraft, at_ms)?;
        }
        Ok(())
    }

    fn sums(&self) -> Result<(), Wrong> {
        let c = self.tracker.counters();
        let tracked = c.born.wrapping_add(c.updated);
        let refused = [
            c.duplicate,
            c.unknown_address,
            c.no_address,
            c.no_place,
            c.broken,
            c.not_tracked,
        ];
        let offered = refused
            .iter()
            .fold(tracked, |sum, count| sum.wrapping_add(*count));
        let positions = c
            .positions_shown
            .wrapping_add(c.positions_waiting)
            .wrapping_add(c.positions_refused);
        let ended = c.timed_out.wrapping_add(c.displaced);
        let born = ended.wrapping_add(self.tracker.len() as u32);
        if (offered, positions, born) == (c.offered, c.positions, c.born) {
            Ok(())
        } else {
            Err(Wrong::Sum(Box::new(c)))
        }
    }
}

impl Default for Subject {
    fn default() -> Subject {
        Subject::new()
    }
}
