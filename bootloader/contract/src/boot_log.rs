//! The boot log: what happened to the image of each slot, in two sectors that only ever grow.
//!
//! ```text
//!   sector   record 0: generation │ record 1 │ record 2 │ … │ 127        32 bytes each, the rest erased
//!
//!   record   0 kind │ 1 slot │ 2 tries or reason │ 3 zero │ 4 image id (8) │ 12 counter (4) │ 16 zero (12) │ 28 CRC-32 of 0..28
//! ```
//! The sector with the higher generation counts. When it is full the other one is erased, filled with what is worth keeping, and gets its
//! generation record last: until then the full one counts, so a cut at any moment loses nothing. A record that a cut tore has a CRC that does
//! not hold; it is stepped over, never written to again.
//!
//! This file is pure: it reads and makes records. Who writes them: the bootloader (pending, trial, rejected), the app (confirmed).

use crate::crc32;
use crate::flash_map::{SLOT_A, SLOT_B, Slot};
use crate::header::ImageId;

/// Bytes of a record.
pub const RECORD: usize = 32;
/// Records of a sector, its generation among them.
pub const RECORDS: usize = 4096 / RECORD;
/// Tries a new image has before it is rejected.
pub const MOST_TRIES: u8 = 3;

/// Which of the two slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotName {
    A,
    B,
}

impl SlotName {
    /// Both.
    pub const ALL: [SlotName; 2] = [SlotName::A, SlotName::B];

    /// 0 or 1.
    pub const fn index(self) -> usize {
        match self {
            SlotName::A => 0,
            SlotName::B => 1,
        }
    }

    /// The other one.
    pub const fn other(self) -> SlotName {
        match self {
            SlotName::A => SlotName::B,
            SlotName::B => SlotName::A,
        }
    }

    /// Where it is.
    pub const fn slot(self) -> Slot {
        match self {
            SlotName::A => SLOT_A,
            SlotName::B => SLOT_B,
        }
    }

    /// One letter.
    pub const fn letter(self) -> &'static str {
        match self {
            SlotName::A => "A",
            SlotName::B => "B",
        }
    }
}

/// One line of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// First of a sector; the higher one counts.
    Generation(u32),
    /// An update put this image into the slot, whole and verified.
    Pending { slot: SlotName, image: ImageId },
    /// The slot's image is about to be started unconfirmed, for the n-th time.
    Trial {
        slot: SlotName,
        image: ImageId,
        tries: u8,
    },
    /// The image said that it works; the floor of the security counter rises to `counter`.
    Confirmed {
        slot: SlotName,
        image: ImageId,
        counter: u32,
    },
    /// The image used up its tries.
    Rejected { slot: SlotName, image: ImageId },
    /// The floor of the security counter, carried into a new sector.
    Floor(u32),
}

const GENERATION: u8 = 0x47;
const PENDING: u8 = 0x50;
const TRIAL: u8 = 0x54;
const CONFIRMED: u8 = 0x43;
const REJECTED: u8 = 0x52;
const FLOOR: u8 = 0x46;

impl Record {
    /// The record as it stands in flash.
    pub fn encode(&self) -> [u8; RECORD] {
        let (kind, slot, tries, image, counter) = match *self {
            Record::Generation(n) => (GENERATION, SlotName::A, 0, [0; 8], n),
            Record::Pending { slot, image } => (PENDING, slot, 0, image, 0),
            Record::Trial { slot, image, tries } => (TRIAL, slot, tries, image, 0),
            Record::Confirmed {
                slot,
                image,
                counter,
            } => (CONFIRMED, slot, 0, image, counter),
            Record::Rejected { slot, image } => (REJECTED, slot, 0, image, 0),
            Record::Floor(counter) => (FLOOR, SlotName::A, 0, [0; 8], counter),
        };
        let mut out = [0; RECORD];
        out[0] = kind;
        out[1] = slot.index() as u8;
        out[2] = tries;
        out[4..12].copy_from_slice(&image);
        out[12..16].copy_from_slice(&counter.to_le_bytes());
        let crc = crc32(&out[..RECORD - 4]);
        out[RECORD - 4..].copy_from_slice(&crc.to_le_bytes());
        out
    }

    /// Reads a record; `None` for anything that is not one, erased flash included.
    pub fn decode(bytes: &[u8; RECORD]) -> Option<Record> {
        let word = |at: usize| {
            u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        if word(RECORD - 4) != crc32(&bytes[..RECORD - 4]) {
            return None;
        }
        let slot = *SlotName::ALL.get(usize::from(bytes[1]))?;
        let mut image = [0; 8];
        image.copy_from_slice(&bytes[4..12]);
        let counter = word(12);
        Some(match bytes[0] {
            GENERATION => Record::Generation(counter),
            PENDING => Record::Pending { slot, image },
            TRIAL => Record::Trial {
                slot,
                image,
                tries: bytes[2],
            },
            CONFIRMED => Record::Confirmed {
                slot,
                image,
                counter,
            },
            REJECTED => Record::Rejected { slot, image },
            FLOOR => Record::Floor(counter),
            _ => return None,
        })
    }
}

/// How far an image has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Installed, never started.
    Pending,
    /// Started this many times without a confirmation.
    Trial(u8),
    /// Works, by its own word.
    Confirmed,
    /// Used up its tries.
    Rejected,
}

/// What the log says, record by record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LogState {
    /// Per slot: the image last spoken of, and its standing.
    pub slots: [Option<(ImageId, Standing)>; 2],
    /// The slot confirmed last.
    pub confirmed_last: Option<SlotName>,
    /// The slot that got an image last: of two unconfirmed ones it is tried first.
    pub installed_last: Option<SlotName>,
    /// Images with a lower security counter are refused.
    pub floor: u32,
}

impl LogState {
    /// Takes the next record.
    pub fn apply(&mut self, record: Record) {
        let (slot, image, standing) = match record {
            Record::Generation(_) => return,
            Record::Floor(counter) => {
                self.floor = self.floor.max(counter);
                return;
            }
            Record::Pending { slot, image } => {
                self.installed_last = Some(slot);
                (slot, image, Standing::Pending)
            }
            Record::Trial { slot, image, tries } => (slot, image, Standing::Trial(tries)),
            Record::Confirmed {
                slot,
                image,
                counter,
            } => {
                self.floor = self.floor.max(counter);
                self.confirmed_last = Some(slot);
                (slot, image, Standing::Confirmed)
            }
            Record::Rejected { slot, image } => (slot, image, Standing::Rejected),
        };
        // A slot that holds something new is not the confirmed one any more.
        if standing != Standing::Confirmed
            && self.confirmed_last == Some(slot)
            && self.slots[slot.index()].is_some_and(|(known, _)| known != image)
        {
            self.confirmed_last = None;
        }
        self.slots[slot.index()] = Some((image, standing));
    }

    /// The standing of the image that is in the slot now; `None` if the log speaks of another or of none.
    pub fn standing(&self, slot: SlotName, image: ImageId) -> Option<Standing> {
        self.slots[slot.index()]
            .filter(|(known, _)| *known == image)
            .map(|(_, standing)| standing)
    }

    /// The records that say the same from nothing, oldest first, without the generation: what a new sector begins with.
    pub fn snapshot(&self) -> impl Iterator<Item = Record> {
        // The slot confirmed or installed last comes last, so that reading the records back finds the same order.
        let is_open = |slot: SlotName| {
            let standing = self.slots[slot.index()].map(|(_, standing)| standing);
            matches!(standing, Some(Standing::Pending | Standing::Trial(_)))
        };
        let last = if SlotName::ALL.into_iter().all(is_open) {
            self.installed_last
        } else {
            self.confirmed_last
        };
        let last = last.unwrap_or(SlotName::B);
        let slots = [last.other(), last].into_iter().flat_map(|slot| {
            let Some((image, standing)) = self.slots[slot.index()] else {
                return [None, None];
            };
            let pending = Record::Pending { slot, image };
            match standing {
                Standing::Pending => [Some(pending), None],
                Standing::Trial(tries) => {
                    let trial = Record::Trial { slot, image, tries };
                    // A trial alone does not say that it was installed last.
                    let installed = self.installed_last == Some(slot);
                    [installed.then_some(pending), Some(trial)]
                }
                // The floor has a record of its own.
                Standing::Confirmed => {
                    let counter = 0;
                    let confirmed = Record::Confirmed {
                        slot,
                        image,
                        counter,
                    };
                    [Some(confirmed), None]
                }
                Standing::Rejected => [Some(Record::Rejected { slot, image }), None],
            }
        });
        core::iter::once(Record::Floor(self.floor)).chain(slots.flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SlotName::{A, B};
    use std::vec::Vec;

    const ONE: ImageId = *b"image  1";
    const TWO: ImageId = *b"image  2";

    fn all() -> Vec<Record> {
        let mut all = std::vec![Record::Generation(7), Record::Floor(9)];
        for slot in SlotName::ALL {
            all.extend([
                Record::Pending { slot, image: ONE },
                Record::Trial {
                    slot,
                    image: ONE,
                    tries: 2,
                },
                Record::Confirmed {
                    slot,
                    image: TWO,
                    counter: 5,
                },
                Record::Rejected { slot, image: TWO },
            ]);
        }
        all
    }

    #[test]
    fn every_record_survives_the_round_trip_and_no_flipped_bit_does() {
        for record in all() {
            let good = record.encode();
            assert_eq!(Record::decode(&good), Some(record));
            for bit in 0..RECORD * 8 {
                let mut bad = good;
                bad[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(Record::decode(&bad), None, "{record:?} bit {bit}");
            }
        }
        assert_eq!(Record::decode(&[0xFF; RECORD]), None);
        assert_eq!(Record::decode(&[0; RECORD]), None);
    }

    #[test]
    fn the_floor_rises_with_confirmations_and_never_falls() {
        let mut log = LogState::default();
        for (counter, floor) in [(3, 3), (2, 3), (8, 8)] {
            log.apply(Record::Confirmed {
                slot: A,
                image: ONE,
                counter,
            });
            assert_eq!(log.floor, floor);
        }
        log.apply(Record::Pending {
            slot: B,
            image: TWO,
        });
        assert_eq!(log.floor, 8);
    }

    #[test]
    fn a_standing_belongs_to_the_image_not_to_the_slot() {
        let mut log = LogState::default();
        log.apply(Record::Confirmed {
            slot: A,
            image: ONE,
            counter: 0,
        });
        assert_eq!(log.standing(A, ONE), Some(Standing::Confirmed));
        assert_eq!(log.standing(A, TWO), None);
        assert_eq!(log.standing(B, ONE), None);
    }

    #[test]
    fn a_slot_that_got_a_new_image_is_not_the_confirmed_one_any_more() {
        let mut log = LogState::default();
        for slot in [A, B] {
            log.apply(Record::Confirmed {
                slot,
                image: ONE,
                counter: 0,
            });
        }
        assert_eq!(log.confirmed_last, Some(B));
        log.apply(Record::Pending {
            slot: B,
            image: TWO,
        });
        assert_eq!(log.confirmed_last, None);
    }

    /// Every state that up to four records lead to is the same after its snapshot was read back.
    #[test]
    fn a_snapshot_says_the_same_from_nothing() {
        let records = all();
        let count = records.len();
        for n in 0..count.pow(4) {
            let mut log = LogState::default();
            let mut rest = n;
            for _ in 0..4 {
                log.apply(records[rest % count]);
                rest /= count;
            }
            let mut again = LogState::default();
            for record in log.snapshot() {
                again.apply(record);
            }
            // Who was confirmed last matters only between two that are confirmed.
            assert_eq!((again.slots, again.floor), (log.slots, log.floor));
            let both = SlotName::ALL
                .iter()
                .all(|slot| log.slots[slot.index()].is_some_and(|(_, s)| s == Standing::Confirmed));
            let open = |slot: &SlotName| {
                let standing = log.slots[slot.index()].map(|(_, standing)| standing);
                matches!(standing, Some(Standing::Pending | Standing::Trial(_)))
            };
            if SlotName::ALL.iter().all(open) {
                assert_eq!(again.installed_last, log.installed_last, "{log:?}");
            }
            if both && log.confirmed_last.is_some() {
                assert_eq!(again.confirmed_last, log.confirmed_last, "{log:?}");
            }
        }
    }
}
