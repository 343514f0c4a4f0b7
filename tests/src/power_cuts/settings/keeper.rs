//! Two ways to keep a blob in such a memory: the firmware's store, and the crate `sequential-storage` beside it, with the sizes it would be given here
//! (words of 32 bytes; units of 2 KiB of EEPROM, or flash sectors).

use std::ops::Range;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use store::{BANKS, Medium, Outcome, Store, Turn};

use crate::cpu_peer::dice::Dice;

use super::memory::{Kind, Memory, Off, PAGE, SECTOR};

/// Bytes of a bank, or unit, of the EEPROM.
const EEPROM_UNIT: usize = 8192 / BANKS as usize;
/// The longest blob: a unit less two words of state, an item's head and its key.
pub const MAX: usize = EEPROM_UNIT - 4 * PAGE;
/// The one key of the map.
const KEY: u8 = 1;

/// Who keeps it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keeper {
    /// `services/store`.
    Banks,
    /// `sequential-storage`, the whole set as one item.
    Sequential,
}

impl Keeper {
    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Keeper::Banks => "four banks",
            Keeper::Sequential => "sequential-storage",
        }
    }

    /// Saves before the one that is cut: drawn from none to once round the memory and a quarter more, so that the cut falls everywhere in the turn.
    pub fn history(self, kind: Kind, size: usize) -> usize {
        let round = match (self, kind) {
            (Keeper::Banks, _) => usize::from(BANKS),
            // A word for the head of an item, two for the state of a unit.
            (Keeper::Sequential, Kind::Eeprom) => 4 * items(EEPROM_UNIT, size),
            (Keeper::Sequential, Kind::Flash) => 4 * items(SECTOR, size),
        };
        Dice::new(size as u64).below(round as u32 * 5 / 4 + 2) as usize
    }

    /// What the next start loads.
    pub fn load(self, memory: &mut Memory) -> Result<Option<Vec<u8>>, Off> {
        match (self, memory.kind) {
            (Keeper::Banks, Kind::Eeprom) => load_banks(Banks::<EEPROM_UNIT>(memory)),
            (Keeper::Banks, Kind::Flash) => load_banks(Banks::<SECTOR>(memory)),
            (Keeper::Sequential, Kind::Eeprom) => load_item(Nor::<EEPROM_UNIT>(memory)),
            (Keeper::Sequential, Kind::Flash) => load_item(Nor::<SECTOR>(memory)),
        }
    }

    /// Saves, after a start.
    pub fn save(self, memory: &mut Memory, blob: &[u8]) -> Result<(), Off> {
        match (self, memory.kind) {
            (Keeper::Banks, Kind::Eeprom) => save_banks(Banks::<EEPROM_UNIT>(memory), blob),
            (Keeper::Banks, Kind::Flash) => save_banks(Banks::<SECTOR>(memory), blob),
            (Keeper::Sequential, Kind::Eeprom) => save_item(Nor::<EEPROM_UNIT>(memory), blob),
            (Keeper::Sequential, Kind::Flash) => save_item(Nor::<SECTOR>(memory), blob),
        }
    }
}

/// Items of this size in a unit of `sequential-storage`.
fn items(unit: usize, size: usize) -> usize {
    (unit / PAGE - 2) / (1 + (size + 1).div_ceil(PAGE))
}

/// The memory as four banks of `UNIT` bytes.
struct Banks<'a, const UNIT: usize>(&'a mut Memory);

impl<const UNIT: usize> Medium for Banks<'_, UNIT> {
    type Error = Off;
    const BANK: usize = UNIT;

    fn read(&mut self, bank: u8, at: usize, out: &mut [u8]) -> Result<(), Off> {
        self.0.read(usize::from(bank) * UNIT + at, out)
    }

    fn prepare(&mut self, bank: u8) -> Result<(), Off> {
        match self.0.kind {
            Kind::Eeprom => Ok(()),
            Kind::Flash => self.0.erase(usize::from(bank) * UNIT),
        }
    }

    fn write(&mut self, bank: u8, page: usize, bytes: &[u8; PAGE]) -> Result<(), Off> {
        self.0
            .program(usize::from(bank) * UNIT + page * PAGE, bytes)
    }

    fn is_busy(&mut self) -> Result<bool, Off> {
        Ok(false)
    }
}

fn load_banks<const UNIT: usize>(banks: Banks<UNIT>) -> Result<Option<Vec<u8>>, Off> {
    let mut store = Store::<_, MAX>::new(banks);
    Ok(store.load()?.map(<[u8]>::to_vec))
}

fn save_banks<const UNIT: usize>(banks: Banks<UNIT>, blob: &[u8]) -> Result<(), Off> {
    let mut store = Store::<_, MAX>::new(banks);
    match store.save(blob) {
        Turn::Ended(Ok(Outcome::Saved | Outcome::Unchanged)) => Ok(()),
        _ => Err(Off),
    }
}

/// The memory as a NOR flash.
struct Nor<'a, const UNIT: usize>(&'a mut Memory);

impl NorFlashError for Off {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const UNIT: usize> ErrorType for Nor<'_, UNIT> {
    type Error = Off;
}

impl<const UNIT: usize> ReadNorFlash for Nor<'_, UNIT> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Off> {
        self.0.read(offset as usize, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.bytes.len()
    }
}

impl<const UNIT: usize> NorFlash for Nor<'_, UNIT> {
    const WRITE_SIZE: usize = PAGE;
    const ERASE_SIZE: usize = UNIT;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Off> {
        match self.0.kind {
            Kind::Flash => (from..to)
                .step_by(SECTOR)
                .try_for_each(|at| self.0.erase(at as usize)),
            Kind::Eeprom => (from..to)
                .step_by(PAGE)
                .try_for_each(|at| self.0.program(at as usize, &[0xff; PAGE])),
        }
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Off> {
        (offset as usize..)
            .step_by(PAGE)
            .zip(bytes.chunks(PAGE))
            .try_for_each(|(at, page)| self.0.program(at, page))
    }
}

/// No cache: as after a start.
type Uncacheds = Cache<Uncached, Uncached, Uncached, u8>;

/// The map over the whole memory.
fn map<const UNIT: usize>(nor: Nor<'_, UNIT>) -> MapStorage<u8, Nor<'_, UNIT>, Uncacheds> {
    let all: Range<u32> = 0..nor.0.bytes.len() as u32;
    MapStorage::new(nor, MapConfig::new(all), Cache::new_uncached())
}

fn load_item<const UNIT: usize>(nor: Nor<UNIT>) -> Result<Option<Vec<u8>>, Off> {
    let mut buffer = [0; SECTOR];
    let found = now(map(nor).fetch_item::<&[u8]>(&mut buffer, &KEY));
    found.map(|blob| blob.map(<[u8]>::to_vec)).map_err(|_| Off)
}

fn save_item<const UNIT: usize>(nor: Nor<UNIT>, blob: &[u8]) -> Result<(), Off> {
    let mut buffer = [0; SECTOR];
    now(map(nor).store_item(&mut buffer, &KEY, &blob)).map_err(|_| Off)
}

/// A future that never waits, to its end.
fn now<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => unreachable!("the memory never waits"),
    }
}
