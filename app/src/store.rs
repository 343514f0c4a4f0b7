//! Where the settings are kept: in the EEPROM, or in flash on a board that has none. The same store over either.
//!
//! ```text
//!   EEPROM   bytes 0 to 8191          four banks of 2 KiB, less the last page, which is the self-test's
//!   flash    0x1FC000 to the end      four sectors of 4 KiB
//! ```
//! A save goes on in turns ([`SettingsStore::begin`], [`SettingsStore::turn`]) of at most 2 ms on the EEPROM: frames, ports and the watchdog are served in
//! between. On flash a turn that erases lasts 45 ms, in which only core 1 goes on. [`SettingsStore::save`] does all turns at once: 18 pages of an
//! EEPROM take 120 ms, and the queue holds 15 ms of the densest traffic; it is for CONFIGURATION, where reception stands still.

use drivers::eeprom::{Eeprom, EepromError};
use hal::board;
use hal::flash::{Flash, Misplaced};
use hal::i2c::I2c1;
use settings::MAX_BYTES;
use store::{Counters, FlashArea, Medium, Outcome, PAGE, SaveError, Store, Turn};

/// Bytes of a bank of the EEPROM: a quarter.
const EEPROM_BANK: usize = drivers::eeprom::BYTES / store::BANKS as usize;
/// The last page of the last bank, which no blob reaches: the self-test's.
pub const SCRATCH_PAGE_AT: usize = drivers::eeprom::BYTES - PAGE;
const _: () = assert!(PAGE == drivers::eeprom::PAGE);
const _: () = assert!(PAGE + MAX_BYTES <= EEPROM_BANK - PAGE);

/// Why settings were not loaded or saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// There are none: a new device, or all banks spoilt.
    Missing,
    /// The EEPROM did not do what was asked.
    Eeprom(EepromError),
    /// The flash refused.
    Flash,
    /// What is written does not read back.
    Worn,
    /// More bytes than there is room for.
    TooLong,
}

impl Trouble {
    /// In a word, for counters and logs.
    pub const fn name(self) -> &'static str {
        match self {
            Trouble::Missing => "missing",
            Trouble::Eeprom(EepromError::Silent) => "eeprom_silent",
            Trouble::Eeprom(EepromError::Refused) => "eeprom_refuses",
            Trouble::Eeprom(EepromError::Bus) => "i2c_held",
            Trouble::Eeprom(EepromError::Misplaced) | Trouble::TooLong => "misplaced",
            Trouble::Flash => "flash_refuses",
            Trouble::Worn => "worn",
        }
    }

    /// What a user is told.
    pub const fn reason(self) -> &'static str {
        match self {
            Trouble::Missing => "Settings missing",
            Trouble::Eeprom(cause) => cause.reason(),
            Trouble::Flash => "flash refuses",
            Trouble::Worn => "memory worn out",
            Trouble::TooLong => "settings too long",
        }
    }
}

impl From<EepromError> for Trouble {
    fn from(cause: EepromError) -> Self {
        Trouble::Eeprom(cause)
    }
}

impl From<Misplaced> for Trouble {
    fn from(_: Misplaced) -> Self {
        Trouble::Flash
    }
}

/// The EEPROM as four banks. Nothing needs to be erased.
struct EepromBanks(Eeprom<I2c1>);

impl Medium for EepromBanks {
    type Error = EepromError;
    const BANK: usize = EEPROM_BANK;

    fn read(&mut self, bank: u8, at: usize, out: &mut [u8]) -> Result<(), EepromError> {
        self.0.read(usize::from(bank) * EEPROM_BANK + at, out)
    }

    fn prepare(&mut self, _: u8) -> Result<(), EepromError> {
        Ok(())
    }

    fn write(&mut self, bank: u8, page: usize, bytes: &[u8; PAGE]) -> Result<(), EepromError> {
        self.0
            .write(usize::from(bank) * EEPROM_BANK + page * PAGE, bytes)
    }

    fn is_busy(&mut self) -> Result<bool, EepromError> {
        self.0.is_busy()
    }
}

enum Backend {
    Eeprom(Store<EepromBanks, MAX_BYTES>),
    Flash(Store<FlashArea<Flash>, MAX_BYTES>),
}

/// The settings' store on this board.
pub struct SettingsStore {
    backend: Backend,
}

impl SettingsStore {
    /// On the EEPROM's bus where the board has one, else in flash. Nothing is read yet.
    pub fn new(i2c: Option<I2c1>, flash: Flash) -> Self {
        let backend = match i2c {
            Some(bus) if board::HAS_EEPROM => {
                let eeprom = Eeprom::new(bus, board::EEPROM_ADDRESS, hal::timer::now_us_low);
                Backend::Eeprom(Store::new(EepromBanks(eeprom)))
            }
            _ => Backend::Flash(Store::new(FlashArea::new(
                flash,
                boot_contract::flash_map::SETTINGS,
            ))),
        };
        Self { backend }
    }

    /// Where it keeps them.
    pub fn place(&self) -> &'static str {
        match self.backend {
            Backend::Eeprom(_) => "EEPROM",
            Backend::Flash(_) => "flash",
        }
    }

    /// The bytes saved last. Takes 15 ms for 512 bytes of the EEPROM; where it does not answer, 10 ms.
    pub fn load(&mut self) -> Result<&[u8], Trouble> {
        match &mut self.backend {
            Backend::Eeprom(store) => store.load()?.ok_or(Trouble::Missing),
            Backend::Flash(store) => store.load()?.ok_or(Trouble::Missing),
        }
    }

    /// Begins a save, which goes on by [`SettingsStore::turn`].
    pub fn begin(&mut self, bytes: &[u8]) -> Result<(), Trouble> {
        match &mut self.backend {
            Backend::Eeprom(store) => store.begin(bytes),
            Backend::Flash(store) => store.begin(bytes),
        }
        .map_err(|_| Trouble::TooLong)
    }

    /// Goes on with a save. `None` while there is more to do; `Some(None)` when no save is under way.
    pub fn turn(&mut self) -> Option<Option<Result<Outcome, Trouble>>> {
        match &mut self.backend {
            Backend::Eeprom(store) => ended(store.turn()),
            Backend::Flash(store) => ended(store.turn()),
        }
    }

    /// Saves, to the end.
    pub fn save(&mut self, bytes: &[u8]) -> Result<Outcome, Trouble> {
        self.begin(bytes)?;
        loop {
            if let Some(Some(result)) = self.turn() {
                return result;
            }
        }
    }

    /// Number of the newest save, and what was counted since the start.
    pub fn counts(&self) -> (u32, Counters) {
        match &self.backend {
            Backend::Eeprom(store) => (store.number(), store.counters()),
            Backend::Flash(store) => (store.number(), store.counters()),
        }
    }

    /// The EEPROM, for its self-test.
    pub fn eeprom(&mut self) -> Option<&mut Eeprom<I2c1>> {
        match &mut self.backend {
            Backend::Eeprom(store) => Some(&mut store.medium().0),
            Backend::Flash(_) => None,
        }
    }

    /// The bus, for what else is on it.
    pub fn bus(&mut self) -> Option<&mut I2c1> {
        self.eeprom().map(Eeprom::bus)
    }
}

fn ended<E>(turn: Turn<E>) -> Option<Option<Result<Outcome, Trouble>>>
where
    Trouble: From<E>,
{
    match turn {
        Turn::Again => None,
        Turn::Idle => Some(None),
        Turn::Ended(result) => Some(Some(result.map_err(|cause| match cause {
            SaveError::TooLong => Trouble::TooLong,
            SaveError::Worn => Trouble::Worn,
            SaveError::Medium(cause) => cause.into(),
        }))),
    }
}
