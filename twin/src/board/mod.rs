//! A board around the chip: flash, radio on PULSES, a USB host on CONSOLE, far ends on the serial ports, EEPROM and potentiometer on
//! I2C, trigger levels and RSSI on the ADC, a GNSS receiver. The nets are in [`kind`].
//!
//! ```text
//!   radio ─ PULSES ─┐                       ┌─ CONSOLE (USB host), COMMS_UART, ESP32, FLARM        ports
//!   RSSI, trigger ──┤ chip ─ I2C ─ EEPROM   ├─ GNSS: NMEA and PPS in true time                    gnss
//!   crystal ────────┘                       └─ faults, planned and carried out                    faults
//! ```

use serde::{Deserialize, Serialize};
pub mod eeprom;
mod faults;
pub mod gnss;
pub mod kind;
pub mod line_noise;
pub mod pin_serial;
mod ports;
pub mod potentiometer;
pub mod settings;

use std::path::Path;

use eeprom::Eeprom;
use gnss::Gnss;
use kind::{ADSBEE_1090, Kind};
use line_noise::LineNoise;
use pin_serial::PinSerial;
pub use ports::{PortName, QUEUE};
use potentiometer::Potentiometer;

use crate::chip::bus::TriggerNet;
use crate::chip::crystal::{Crystal, Deviation};
use crate::chip::flash::Flash;
use crate::chip::pins::{Again, Played};
use crate::chip::uart::FarFormat;
use crate::chip::{Chip, Halt};
use crate::fault::{Memory, Planned};
use crate::front_end::PulseSource;
use crate::front_end::trigger_level::TriggerLevel;
use crate::image;
use crate::source::random::Random;

/// The flash's unique id, where nobody names another.
const UNIQUE_ID: [u8; 8] = *b"SQUITTER";
/// Cycles of one capture word: 32 samples of 15 cycles.
const WORD_CYCLES: u64 = 480;
/// A playback starts on a multiple of so many capture words: of the 64 at which the demodulator steers its gate, and of the 7 and the 109 after which the
/// second sampler (a sample in 7 cycles) and the converter (one in 272.5) stand at the same phase of a word again. 195 ms.
const PLAY_STEP_WORDS: u64 = 64 * 7 * 109;
/// Cycles between a pin and the sampler that reads it.
const SYNC_CYCLES: u64 = 2;
/// The system clock the images set; ticks are defined by it.
pub const TICK_HZ: u64 = 120_000_000;
/// How long an image may take to start capture, and a host to open the port.
const START_SECONDS: u64 = 6;
/// Within this time of the port's opening the device has said its first words, ms.
const GREETING_MS: u64 = 5;
/// How long a trigger level may take to settle behind its RC, ms: fourteen time constants.
const SETTLE_MS: u64 = 140;
/// FLARM's usual rate, bits a second (its data port specification).
const FLARM_BAUD: u32 = 19_200;

/// Why the board did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Image(#[from] image::Error),
    #[error("the chip stopped: {0}")]
    Halted(#[from] Halt),
    #[error(
        "the image did not start capture within {START_SECONDS} s; {why}COMMS_UART said: {comms:?}"
    )]
    NoCapture { comms: String, why: &'static str },
    #[error(
        "what plays into PULSES cannot be repeated, so the board cannot be forked (play_repeatable)"
    )]
    Unrepeatable,
    #[error("the board {board} has no {what}")]
    NoSuchPart {
        board: &'static str,
        what: &'static str,
    },
    #[error("{memory:?} has no byte {address:#x}")]
    NoSuchByte { memory: Memory, address: u32 },
    #[error(
        "the image did not open its USB console within {START_SECONDS} s; COMMS_UART said: {comms:?}; USB: {usb}"
    )]
    NoConsole { comms: String, usb: String },
}

/// What a board is built from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    pub kind: Kind,
    pub crystal: Deviation,
    /// The GNSS receiver's settings; `None` leaves its place open for a program outside.
    pub gnss: Option<gnss::Options>,
    /// Contents of the EEPROM; `None` is a new one.
    pub eeprom: Option<Vec<u8>>,
    /// Rate of FLARM's serial line, bits a second.
    pub flarm_baud: u32,
    /// Seed of all that is random about faults.
    pub seed: u64,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            kind: ADSBEE_1090,
            crystal: Deviation::default(),
            gnss: None,
            eeprom: None,
            flarm_baud: FLARM_BAUD,
            seed: 1,
        }
    }
}

/// A powered board.
#[derive(Clone, Serialize, Deserialize)]
pub struct Board {
    pub chip: Chip,
    pub kind: Kind,
    /// Cycle of the first sample of the playback, once it runs.
    playback: Option<Playback>,
    /// Faults that have not happened yet.
    planned: Vec<Planned>,
    /// Memories in which bits turn over at random.
    flipping: Vec<Memory>,
    /// How often the supply failed or dipped, and how many bits turned over.
    pub power_cuts: u64,
    pub flips: u64,
    random: Random,
    /// Noise on the wires of the UARTs from the device to their far ends; the other way is the far ends' own.
    noise_from_device: [LineNoise; 2],
}

/// Where a playback stands in the device's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Playback {
    /// Cycle at which playback time zero falls.
    pub start_cycle: u64,
    /// The device's tick count there: cycles since its first sample.
    pub start_tick: u64,
    /// True time of it, picoseconds since power-on: what GNSS and PPS count in.
    pub start_true_ps: u128,
}

impl Board {
    /// Flashes `uf2` and switches the power of an `adsbee_1090` on.
    pub fn power_on(uf2: &Path) -> Result<Self, Error> {
        let mut flash = Flash::new(ADSBEE_1090.flash_bytes, UNIQUE_ID);
        image::flash_uf2(uf2, &mut flash)?;
        Ok(Self::with_flash(flash))
    }

    /// Switches the power of an `adsbee_1090` on with these flash contents.
    pub fn with_flash(flash: Flash) -> Self {
        Self::new(flash, &Setup::default())
    }

    /// Builds a board and switches the power on.
    pub fn new(flash: Flash, setup: &Setup) -> Self {
        let mut chip = Chip::new(flash);
        let kind = setup.kind;
        let bus = &mut chip.bus;
        bus.crystal = Crystal::new(setup.crystal);
        let nets = kind.trigger_levels.iter();
        bus.trigger_nets = nets
            .map(|net| TriggerNet {
                gpio: net.pwm,
                adc: net.adc,
                level: TriggerLevel::default(),
            })
            .collect();
        bus.apply_trigger_level();
        bus.rssi_adc = Some(kind.rssi_adc);
        // UART lines idle high.
        bus.pins.drive(kind.comms_rx, true);
        bus.pins.drive(kind.flarm_rx, true);
        bus.pins.drive(kind.pulses, false);
        bus.attach(Box::new(PinSerial::new(kind.flarm_rx, setup.flarm_baud)));
        let mut board = Self {
            chip,
            kind,
            playback: None,
            planned: Vec::new(),
            flipping: Vec::new(),
            power_cuts: 0,
            flips: 0,
            random: Random::new(setup.seed),
            noise_from_device: [1, 2].map(|n| LineNoise::new(setup.seed ^ n)),
        };
        board.wire_i2c(setup);
        board.wire_gnss(setup);
        board
    }

    fn wire_i2c(&mut self, setup: &Setup) {
        let Some(nets) = self.kind.i2c else { return };
        let i2c = &mut self.chip.bus.i2c[nets.controller];
        i2c.wire_to(nets.sda, nets.scl);
        let mut eeprom = Eeprom::new(nets.eeprom);
        if let Some(contents) = &setup.eeprom {
            let count = contents.len().min(eeprom::BYTES);
            eeprom.bytes_mut()[..count].copy_from_slice(&contents[..count]);
        }
        i2c.attach(Box::new(eeprom));
        if let Some(address) = nets.potentiometer {
            i2c.attach(Box::new(Potentiometer::new(address)));
        }
    }

    fn wire_gnss(&mut self, setup: &Setup) {
        let Some(nets) = self.kind.gnss else { return };
        self.chip.bus.pins.drive(nets.rx, true);
        if let Some(options) = &setup.gnss {
            self.chip.bus.pins.drive(nets.pps, false);
            let wired = gnss::Nets {
                uart: nets.uart,
                pps: nets.pps,
                enable: nets.enable,
            };
            let format = FarFormat::eight_n_one(options.baud);
            self.chip.bus.uart[nets.uart].far.format = Some(format);
            let receiver = Gnss::new(options.clone(), wired);
            self.chip.bus.attach(Box::new(receiver));
        }
    }

    /// Emulated time since power-on in seconds.
    pub fn seconds(&self) -> f64 {
        self.chip.bus.time_ps() as f64 * 1e-12
    }

    /// Runs for a number of system cycles.
    pub fn run_cycles(&mut self, cycles: u64) -> Result<(), Error> {
        let until = self.chip.now() + cycles;
        self.run_to(until)
    }

    /// Runs for a time, at whatever rate the system clock has.
    pub fn run_ms(&mut self, ms: u64) -> Result<(), Error> {
        let end = self.chip.bus.time_ps() + u128::from(ms) * 1_000_000_000;
        while self.chip.bus.time_ps() < end {
            let left = end - self.chip.bus.time_ps();
            let cycles = left * u128::from(self.chip.bus.sys_hz()) / 1_000_000_000_000;
            // In small steps, since a program may change its clock on the way.
            self.run_cycles((cycles as u64).clamp(1, TICK_HZ / 1000))?;
        }
        Ok(())
    }

    /// Runs until `done` or for at most `seconds`; says whether it was done.
    pub fn run_until(
        &mut self,
        seconds: u64,
        mut done: impl FnMut(&mut Self) -> bool,
    ) -> Result<bool, Error> {
        for _ in 0..seconds * 1000 {
            if done(self) {
                return Ok(true);
            }
            self.run_ms(1)?;
        }
        Ok(done(self))
    }

    fn comms_text(&mut self) -> String {
        String::from_utf8_lossy(&self.comms_read()).into_owned()
    }

    /// Runs until the image samples PULSES.
    pub fn wait_for_capture(&mut self) -> Result<(), Error> {
        let running = |b: &mut Self| b.chip.bus.pio[0].enabled_at[0] != 0;
        if self.run_until(START_SECONDS, running)? {
            return Ok(());
        }
        let why = if self.chip.bus.crystal_is_dead() {
            "the crystal does not oscillate, so XOSC STATUS.STABLE stays 0 and the firmware waits for it; "
        } else {
            ""
        };
        Err(Error::NoCapture {
            comms: self.comms_text(),
            why,
        })
    }

    /// Runs until the host has opened the console, and for the moment in which the device greets it.
    pub fn wait_for_console(&mut self) -> Result<(), Error> {
        if self.run_until(START_SECONDS, |b| b.chip.bus.usb_host.open)? {
            return self.run_ms(GREETING_MS);
        }
        Err(Error::NoConsole {
            comms: self.comms_text(),
            usb: self.chip.bus.usb_host.faults.join("; "),
        })
    }

    /// A host is plugged in that opens the console, or has it open.
    pub fn console_expected(&self) -> bool {
        let host = &self.chip.bus.usb_host;
        host.plugged() && host.opens
    }

    /// Runs until the host has opened the console; false where none is there that would.
    pub fn wait_for_console_if_expected(&mut self) -> Result<bool, Error> {
        if !self.console_expected() {
            return Ok(false);
        }
        match self.wait_for_console() {
            Ok(()) => Ok(true),
            Err(Error::NoConsole { .. }) if !self.console_expected() => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// The console is open, and the host reads what it says.
    pub fn console_answers(&self) -> bool {
        let host = &self.chip.bus.usb_host;
        host.open && host.reading
    }

    /// Starts playback of `source`: its time zero falls on the first sample of a capture word, so that a native run of the same
    /// source with phase zero samples the very same instants. The trigger level has settled by then, as on a board that is on.
    pub fn play(&mut self, source: Box<dyn PulseSource + Send>) -> Result<Playback, Error> {
        self.start_playing(Played::Once(source))
    }

    /// The same with a source that can be made anew, so that the board can be forked while it plays.
    pub fn play_repeatable(&mut self, again: Again) -> Result<Playback, Error> {
        self.start_playing(Played::Again(again))
    }

    /// A copy of the whole board at this moment, chip and all that is attached: what happens to one does not concern the other, and both
    /// go on alike, bit for bit and cycle for cycle.
    pub fn fork(&self) -> Result<Self, Error> {
        if !self.chip.bus.pins.playback_repeatable() {
            return Err(Error::Unrepeatable);
        }
        Ok(self.clone())
    }

    fn start_playing(&mut self, source: Played) -> Result<Playback, Error> {
        self.wait_for_capture()?;
        for _ in 0..SETTLE_MS {
            if self.chip.bus.trigger_levels_settled() {
                break;
            }
            self.run_ms(1)?;
        }
        let first = self.chip.bus.pio[0].enabled_at[0] + 1;
        let words = ((self.chip.now() - first) / WORD_CYCLES + 2).next_multiple_of(PLAY_STEP_WORDS);
        let start = first + words * WORD_CYCLES;
        let pulses = self.kind.pulses;
        let start_true_ps = self.chip.bus.play(source, pulses, start - SYNC_CYCLES);
        let playback = Playback {
            start_true_ps,
            start_cycle: start,
            start_tick: words * WORD_CYCLES,
        };
        self.playback = Some(playback);
        // The wait belongs to nobody's time of the air.
        let ahead = start.saturating_sub(self.chip.now() + WORD_CYCLES);
        self.run_cycles(ahead)?;
        Ok(playback)
    }

    /// The source is at its end and all its edges were played.
    pub fn playback_finished(&self) -> bool {
        self.chip.bus.pins.playback_finished()
    }

    /// The status LED.
    pub fn led(&self) -> bool {
        self.chip.bus.pins.level(self.kind.led)
    }
}

#[cfg(test)]
mod board_tests;

/// The trigger level the firmware's PWM makes at its default of 1300 mV: 1970 of 5000 counts of 3300 mV.
pub fn pwm_level_mv() -> f64 {
    1970.0 / 5000.0 * 3300.0
}
