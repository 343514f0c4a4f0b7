//! What the shell asks of the device, carried out.
//!
//! A set is put into force at once: COMMS_UART's rate in RUN (in CONFIGURATION on leaving), protocols, trigger level. What the board has no part for is
//! refused before anything changes.

use crate::hardware::{Hardware, Refused};
use crate::info;
use crate::receiver::Receiver;
use crate::self_test;
use crate::store::{SettingsStore, Trouble};
use hal::uart::actual_baud;
use mode_s::{Icao, Position};
use settings::choices::RxSource;
use settings::{MAX_BYTES, Settings, Stored};
use shell::{BaudRates, Device, Failure, Identity, Out, Report, Saving};
use tracker::RxPosition;

impl Device for Receiver {
    fn settings(&self) -> &Settings {
        &self.stored.settings
    }

    fn apply(&mut self, settings: &Settings) -> Result<(), Failure> {
        let old = self.stored.settings;
        set_parts(&mut self.hardware, &mut self.store, &old, settings).map_err(Refused::reason)?;
        self.stored.settings = *settings;
        self.follow(&old);
        Ok(())
    }

    fn save(&mut self) -> Result<Saving, Failure> {
        // A page a turn, since frames are received meanwhile.
        let mut bytes = [0; MAX_BYTES];
        let length = self.stored.save(&mut bytes);
        self.store
            .begin(&bytes[..length])
            .map_err(Trouble::reason)?;
        Ok(Saving::UnderWay)
    }

    fn load(&mut self) -> Result<(), Failure> {
        let stored = load(&mut self.store).map_err(Trouble::reason)?;
        self.apply(&stored.settings)?;
        self.stored = stored;
        Ok(())
    }

    fn identity(&self) -> Identity<'_> {
        let serial = self.stored.settings.serial.as_str();
        Identity {
            device: &self.board,
            version: &self.version,
            serial: if serial.is_empty() {
                &self.serial
            } else {
                serial
            },
        }
    }

    fn baud_rates(&self) -> BaudRates {
        BaudRates {
            comms_uart: actual_baud(self.stored.settings.comms_baud),
            gnss_uart: actual_baud(self.stored.settings.gnss_baud),
        }
    }

    fn uptime_s(&self) -> u32 {
        self.run_s()
    }

    fn rx_gain(&mut self) -> Result<u8, Failure> {
        self.hardware
            .rx_gain(&mut self.store)
            .map_err(Refused::reason)
    }

    fn trigger_levels(&mut self) -> Result<(Option<u16>, u16), Failure> {
        Ok((self.air.read_low_mv(), self.air.read_mv()))
    }

    fn usb_drive_allowed(&mut self) -> &mut bool {
        &mut self.is_usb_drive_allowed
    }

    fn tell(&mut self, report: Report, prefix: &str, out: &mut dyn Out) -> Result<(), Failure> {
        match report {
            Report::Stats => {
                self.stats().lines(|line| {
                    if let Ok(line) = line {
                        out.line(format_args!("{prefix}{line}"));
                    }
                });
                Ok(())
            }
            Report::Info => {
                info::tell(self, out);
                Ok(())
            }
            Report::Test => {
                let checks = self_test::run(self);
                for check in &checks {
                    out.line(format_args!("{check}"));
                }
                let failed = checks.iter().find(|check| !check.passed);
                failed.map_or(Ok(()), |check| Err(check.name))
            }
            Report::Gnss => {
                out.line(format_args!("{prefix}GNSS={}", self.clock.status()));
                Ok(())
            }
        }
    }
}

/// What is stored, each value judged; what is whole and no set counts as missing.
pub fn load(store: &mut SettingsStore) -> Result<Stored, Trouble> {
    store
        .load()
        .and_then(|bytes| Stored::load(bytes).ok_or(Trouble::Missing))
}

/// Where the receiver stands, as set. The GNSS receiver's word comes with each second.
fn rx_position(settings: &Settings) -> RxPosition {
    match settings.rx_source {
        RxSource::None => RxPosition::None,
        RxSource::Fixed => RxPosition::Fixed(Position {
            latitude: settings.rx_lat_e7,
            longitude: settings.rx_lon_e7,
        }),
        RxSource::Gnss => RxPosition::Gnss(None),
        RxSource::Lowest => RxPosition::Lowest,
        RxSource::Icao => RxPosition::Icao(Icao(settings.rx_icao)),
    }
}

/// Sets the parts whose settings differ; what the board lacks is refused.
fn set_parts(
    hardware: &mut Hardware,
    store: &mut SettingsStore,
    old: &Settings,
    new: &Settings,
) -> Result<(), Refused> {
    if old.rx_gain != new.rx_gain {
        hardware.set_rx_gain(store, new.rx_gain)?;
    }
    if old.bias_tee != new.bias_tee {
        hardware.set_bias_tee(new.bias_tee)?;
    }
    if old.esp32 != new.esp32 {
        hardware.set_esp32(new.esp32)?;
    }
    Ok(())
}

impl Receiver {
    /// Acts on what differs from the old set.
    pub fn follow(&mut self, old: &Settings) {
        let new = self.stored.settings;
        self.apply_reports();
        if new.comms_baud != old.comms_baud && self.is_rate_as_set() {
            // In range: the set was checked.
            let _ = self.comms.port.outlet.0.request_baud(new.comms_baud);
        }
        if new.rx_source != old.rx_source
            || (new.rx_lat_e7, new.rx_lon_e7, new.rx_icao)
                != (old.rx_lat_e7, old.rx_lon_e7, old.rx_icao)
        {
            self.tracker.set_rx_position(rx_position(&new));
        }
        self.hardware.set_trigger_level_low(new.tl_lo_mv);
        let level = |set: &Settings| (set.tl_mode, set.tl_lo_mv, set.tl_hi_mv);
        if level(&new) != level(old) {
            self.air.follow(&new);
        }
    }

    /// Puts what both ports carry, and the GNSS receiver's rate and delay, into force.
    pub fn apply_reports(&mut self) {
        self.clock.apply(&self.stored.settings);
        self.console.apply(&self.stored.settings);
        self.comms.apply(&self.stored.settings);
    }

    /// Acts on the whole set, at a start: the parts are as after a reset. What the board lacks cannot have been set on it.
    pub fn act_on_all(&mut self) {
        let settings = self.stored.settings;
        let _ = self.hardware.set_bias_tee(settings.bias_tee);
        let _ = self.hardware.set_esp32(settings.esp32);
        let _ = self.hardware.set_rx_gain(&mut self.store, settings.rx_gain);
        self.hardware.set_trigger_level_low(settings.tl_lo_mv);
        self.apply_reports();
        self.tracker.set_rx_position(rx_position(&settings));
        // In range: it was judged when it was loaded.
        let _ = self.comms.port.outlet.0.request_baud(settings.comms_baud);
    }

    /// Stores the set in force, to the end: reception stands still.
    pub fn save_at_once(&mut self) -> Result<(), Failure> {
        let mut bytes = [0; MAX_BYTES];
        let length = self.stored.save(&mut bytes);
        self.store.save(&bytes[..length]).map_err(Trouble::reason)?;
        self.saved();
        Ok(())
    }

    /// A turn of the save that `save` began; what came of it when it is over.
    pub fn saving_turn(&mut self) -> Option<Result<(), Failure>> {
        match self.store.turn()? {
            Some(Ok(_)) => {
                self.saved();
                Some(Ok(()))
            }
            Some(Err(trouble)) => Some(Err(trouble.reason())),
            None => Some(Err("no save is under way")),
        }
    }

    fn saved(&mut self) {
        self.settings_trouble = None;
        self.states.are_missing = false;
    }
}
