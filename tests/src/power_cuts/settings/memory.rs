//! The memories that settings are kept in, with a supply that fails: before an operation, at a byte of it, or inside it.
//!
//! | | an operation | cut at byte k | cut inside |
//! |---|---|---|---|
//! | EEPROM | a page of 32 bytes, written over | k bytes are new, the rest old | any byte is old, new, or has some of the differing bits |
//! | flash | 32 bytes programmed: bits fall | k bytes are programmed | some bytes are, the next in part, the rest not |
//! | flash | a sector of 4 KiB erased: bits rise | k/32 of it is erased | each byte is old, erased, or has some bits set |
//!
//! The EEPROM's data sheet promises nothing about a page whose write cycle is cut; bytes outside of it are taken to be safe, as in the twin.

use crate::cpu_peer::dice::Dice;

/// Bytes written at once.
pub const PAGE: usize = 32;
/// Bytes of a flash sector.
pub const SECTOR: usize = 4096;

/// Which memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// M24C64.
    Eeprom,
    /// Four sectors of the flash.
    Flash,
}

impl Kind {
    /// Both.
    pub const ALL: [Kind; 2] = [Kind::Eeprom, Kind::Flash];

    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Eeprom => "EEPROM",
            Kind::Flash => "flash",
        }
    }

    fn bytes(self) -> usize {
        match self {
            Kind::Eeprom => 8192,
            Kind::Flash => 4 * SECTOR,
        }
    }
}

/// How the operation under way ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Torn {
    /// After so many of its 32 bytes.
    AtByte(usize),
    /// As this seed draws.
    Inside(u64),
}

/// The supply fails in the operation after `after` others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    pub after: usize,
    pub torn: Torn,
}

/// The supply has failed, or nobody should have asked that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Off;

/// The memory.
#[derive(Clone)]
pub struct Memory {
    pub kind: Kind,
    pub bytes: Vec<u8>,
    /// Operations since the start.
    pub operations: usize,
    cut: Option<Cut>,
    off: bool,
}

impl Memory {
    /// A new one: all ones.
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            bytes: vec![0xff; kind.bytes()],
            operations: 0,
            cut: None,
            off: false,
        }
    }

    /// Plans a failure of the supply.
    pub fn cut(&mut self, cut: Cut) {
        self.cut = Some(cut);
    }

    /// The supply is back, for good.
    pub fn power_on(&mut self) {
        self.off = false;
        self.cut = None;
    }

    /// Whether the planned failure has happened.
    pub fn is_off(&self) -> bool {
        self.off
    }

    /// Reads.
    pub fn read(&self, at: usize, out: &mut [u8]) -> Result<(), Off> {
        let from = self.bytes.get(at..at + out.len());
        match from {
            Some(bytes) if !self.off => out.copy_from_slice(bytes),
            _ => return Err(Off),
        }
        Ok(())
    }

    /// An operation begins: how it ends.
    fn begin(&mut self) -> Result<Option<Torn>, Off> {
        if self.off {
            return Err(Off);
        }
        match &mut self.cut {
            Some(cut) if cut.after == 0 => {
                self.off = true;
                Ok(Some(cut.torn))
            }
            cut => {
                if let Some(cut) = cut {
                    cut.after -= 1;
                }
                self.operations += 1;
                Ok(None)
            }
        }
    }

    /// Writes bytes of one page: over what is there, or as flash does.
    pub fn program(&mut self, at: usize, bytes: &[u8]) -> Result<(), Off> {
        assert_eq!(at / PAGE, (at + bytes.len() - 1) / PAGE, "one page");
        let torn = self.begin()?;
        let kind = self.kind;
        let cells = self.bytes.get_mut(at..at + bytes.len()).ok_or(Off)?;
        let whole = |old: u8, new: u8| match kind {
            Kind::Eeprom => new,
            Kind::Flash => old & new,
        };
        let mut dice = match torn {
            None => {
                for (cell, &byte) in cells.iter_mut().zip(bytes) {
                    *cell = whole(*cell, byte);
                }
                return Ok(());
            }
            Some(Torn::AtByte(count)) => {
                for (cell, &byte) in cells.iter_mut().zip(bytes).take(count) {
                    *cell = whole(*cell, byte);
                }
                return Err(Off);
            }
            Some(Torn::Inside(seed)) => Dice::new(seed),
        };
        let done = dice.below(17);
        for (cell, &byte) in cells.iter_mut().zip(bytes) {
            let (old, new) = (*cell, whole(*cell, byte));
            *cell = if dice.below(16) < done {
                // The cells of an EEPROM's page are erased before they are programmed: bits that do not change may stand wrong too.
                match (dice.below(3), kind) {
                    (0, Kind::Eeprom) => dice.bits() as u8,
                    (0, Kind::Flash) => old & (new | dice.bits() as u8),
                    _ => new,
                }
            } else {
                old
            };
        }
        Err(Off)
    }

    /// Erases a sector of the flash.
    pub fn erase(&mut self, at: usize) -> Result<(), Off> {
        let torn = self.begin()?;
        let cells = self.bytes.get_mut(at..at + SECTOR).ok_or(Off)?;
        match torn {
            None => cells.fill(0xff),
            Some(Torn::AtByte(count)) => {
                cells[..SECTOR / PAGE * count].fill(0xff);
                return Err(Off);
            }
            Some(Torn::Inside(seed)) => {
                let mut dice = Dice::new(seed);
                let done = 1 + dice.below(16);
                for cell in cells {
                    if dice.below(16) < done {
                        *cell |= match dice.below(4) {
                            0 => dice.bits() as u8,
                            _ => 0xff,
                        };
                    }
                }
                return Err(Off);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_leaves_part_of_its_operation_and_nothing_after_it() {
        for kind in Kind::ALL {
            let mut memory = Memory::new(kind);
            memory.cut(Cut {
                after: 1,
                torn: Torn::AtByte(5),
            });
            memory.program(0, &[1; 32]).unwrap();
            assert_eq!(memory.program(32, &[2; 32]), Err(Off));
            assert_eq!(memory.read(0, &mut [0]), Err(Off));
            assert_eq!(memory.program(64, &[3; 32]), Err(Off));
            memory.power_on();
            assert_eq!(memory.bytes[..32], [1; 32]);
            assert_eq!(memory.bytes[32..37], [2; 5]);
            assert!(memory.bytes[37..].iter().all(|&byte| byte == 0xff));
        }
    }

    #[test]
    fn a_cut_inside_spoils_its_page_alone_and_in_many_ways() {
        for kind in Kind::ALL {
            let mut ways = std::collections::BTreeSet::new();
            for seed in 0..100 {
                let mut memory = Memory::new(kind);
                memory.program(32, &[0xa5; 32]).unwrap();
                memory.cut(Cut {
                    after: 0,
                    torn: Torn::Inside(seed),
                });
                assert_eq!(memory.program(0, &[0x5a; 32]), Err(Off));
                assert_eq!(memory.bytes[32..64], [0xa5; 32]);
                ways.insert(memory.bytes[..32].to_vec());
            }
            assert!(ways.len() > 90, "{kind:?}: {}", ways.len());
        }
    }

    #[test]
    fn an_erase_cut_inside_leaves_old_bytes_between_erased_ones() {
        let mut memory = Memory::new(Kind::Flash);
        memory.bytes.fill(0);
        memory.cut(Cut {
            after: 0,
            torn: Torn::Inside(3),
        });
        assert_eq!(memory.erase(SECTOR), Err(Off));
        let erased = memory.bytes.iter().filter(|&&byte| byte == 0xff).count();
        assert!((1..SECTOR).contains(&erased), "{erased}");
        assert!(memory.bytes[..SECTOR].iter().all(|&byte| byte == 0));
    }
}
