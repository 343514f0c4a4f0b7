//! The board `adsbee_1090` around the chip: flash, radio on PULSES, a USB host on CONSOLE, far ends on the UARTs.
//!
//! | net | GPIO | here |
//! |---|---|---|
//! | PULSES | 19 | edges from the front end |
//! | trigger level | 25 | PWM duty of 3300 mV, without the RC's delay |
//! | COMMS_UART | 4, 5 | UART1 |
//! | GNSS_UART | 0, 1 | UART0 |
//! | CONSOLE | USB | CDC-ACM host |
//!
//! Not modelled yet: EEPROM, ADC inputs, GNSS receiver, ESP32.

use std::path::Path;

use crate::chip::flash::Flash;
use crate::chip::{Chip, Halt};
use crate::front_end::PulseSource;
use crate::image;

const PULSES: u32 = 19;
const LED: u32 = 15;
/// Flash of the smallest supported board (2 MiB, BOOT_NOTES flash map).
const FLASH_BYTES: usize = 2 << 20;
/// Cycles of one capture word: 32 samples of 15 cycles.
const WORD_CYCLES: u64 = 480;
/// Cycles between a pin and the sampler that reads it.
const SYNC_CYCLES: u64 = 2;
/// The system clock the images set; ticks are defined by it.
pub const TICK_HZ: u64 = 120_000_000;
/// How long an image may take to start capture, and a host to open the port.
const START_SECONDS: u64 = 4;

/// Why the board did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Image(#[from] image::Error),
    #[error("the chip stopped: {0}")]
    Halted(#[from] Halt),
    #[error("the image did not start capture within {START_SECONDS} s; COMMS_UART said: {comms:?}")]
    NoCapture { comms: String },
    #[error(
        "the image did not open its USB console within {START_SECONDS} s; COMMS_UART said: {comms:?}; USB: {usb}"
    )]
    NoConsole { comms: String, usb: String },
}

/// A powered board.
pub struct Board {
    pub chip: Chip,
    /// Cycle of the first sample of the playback, once it runs.
    playback: Option<Playback>,
}

/// Where a playback stands in the device's time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Playback {
    /// Cycle at which playback time zero falls.
    pub start_cycle: u64,
    /// The device's tick count there: cycles since its first sample.
    pub start_tick: u64,
}

impl Board {
    /// Flashes `uf2` and switches the power on.
    pub fn power_on(uf2: &Path) -> Result<Self, Error> {
        let mut flash = Flash::new(FLASH_BYTES, *b"SQUITTER");
        image::flash_uf2(uf2, &mut flash)?;
        Ok(Self::with_flash(flash))
    }

    /// Switches the power on with these flash contents.
    pub fn with_flash(flash: Flash) -> Self {
        let mut chip = Chip::new(flash);
        // UART lines idle high.
        for rx in [1, 5] {
            chip.bus.pins.drive(rx, true);
        }
        chip.bus.pins.drive(PULSES, false);
        Self {
            chip,
            playback: None,
        }
    }

    /// Emulated time since power-on in seconds.
    pub fn seconds(&self) -> f64 {
        self.chip.bus.time_ps() as f64 * 1e-12
    }

    /// Runs for a number of system cycles.
    pub fn run_cycles(&mut self, cycles: u64) -> Result<(), Error> {
        let until = self.chip.now() + cycles;
        Ok(self.chip.run_until(until)?)
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
        Err(Error::NoCapture {
            comms: self.comms_text(),
        })
    }

    /// Runs until the host has opened the console.
    pub fn wait_for_console(&mut self) -> Result<(), Error> {
        if self.run_until(START_SECONDS, |b| b.chip.bus.usb_host.open)? {
            return Ok(());
        }
        Err(Error::NoConsole {
            comms: self.comms_text(),
            usb: self.chip.bus.usb_host.faults.join("; "),
        })
    }

    /// Starts playback of `source`: its time zero falls on the first sample of the next capture word, so that a native run of the same
    /// source with phase zero samples the very same instants.
    pub fn play(&mut self, source: Box<dyn PulseSource + Send>) -> Result<Playback, Error> {
        self.wait_for_capture()?;
        let first = self.chip.bus.pio[0].enabled_at[0] + 1;
        let words = (self.chip.now() - first) / WORD_CYCLES + 2;
        let start = first + words * WORD_CYCLES;
        self.chip.bus.pins.play(source, PULSES, start - SYNC_CYCLES);
        self.chip.bus.apply_trigger_level();
        let playback = Playback {
            start_cycle: start,
            start_tick: words * WORD_CYCLES,
        };
        self.playback = Some(playback);
        Ok(playback)
    }

    /// The source is at its end and all its edges were played.
    pub fn playback_finished(&self) -> bool {
        self.chip.bus.pins.playback_finished()
    }

    /// Bytes typed on the console.
    pub fn console_write(&mut self, bytes: &[u8]) {
        self.chip.bus.usb_host.to_device.extend(bytes);
    }

    /// Bytes the console has said since the last call.
    pub fn console_read(&mut self) -> Vec<u8> {
        self.chip.bus.usb_host.from_device.drain(..).collect()
    }

    /// Bytes for the device from the far end of COMMS_UART.
    pub fn comms_write(&mut self, bytes: &[u8]) {
        let now = self.chip.now();
        self.chip.bus.uart[1].send(bytes, now);
    }

    /// Bytes COMMS_UART has sent since the last call.
    pub fn comms_read(&mut self) -> Vec<u8> {
        let sent = &mut self.chip.bus.uart[1].sent;
        sent.drain(..).map(|(_, byte)| byte).collect()
    }

    /// Bytes for the device from the GNSS receiver's place.
    pub fn gnss_write(&mut self, bytes: &[u8]) {
        let now = self.chip.now();
        self.chip.bus.uart[0].send(bytes, now);
    }

    /// Bytes GNSS_UART has sent since the last call.
    pub fn gnss_read(&mut self) -> Vec<u8> {
        let sent = &mut self.chip.bus.uart[0].sent;
        sent.drain(..).map(|(_, byte)| byte).collect()
    }

    /// The status LED.
    pub fn led(&self) -> bool {
        self.chip.bus.pins.level(LED)
    }
}

/// The trigger level the firmware's PWM makes at its default of 1300 mV: 1970 of 5000 counts of 3300 mV.
pub fn pwm_level_mv() -> f64 {
    1970.0 / 5000.0 * 3300.0
}
