//! A device without hardware: settings that act on nothing, a store that works. For tests and the fuzzer.

use crate::device::{BaudRates, Device, Failure, Identity, Report, Saving};
use crate::dialect::Out;
use settings::Settings;

/// The device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// In force.
    pub settings: Settings,
    /// Stored.
    pub stored: Option<Settings>,
    /// Whether the board has the gain's potentiometer.
    pub has_gain: bool,
    /// What the self-test finds.
    pub broken: Option<Failure>,
    /// Times something was stored.
    pub saves: u32,
    /// Whether the ROM's drive may be entered.
    pub usb_drive: bool,
}

impl Default for Model {
    fn default() -> Self {
        Self {
            settings: Settings::FACTORY,
            stored: None,
            has_gain: false,
            broken: None,
            saves: 0,
            usb_drive: false,
        }
    }
}

impl Device for Model {
    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn apply(&mut self, settings: &Settings) -> Result<(), Failure> {
        if settings.rx_gain != self.settings.rx_gain && !self.has_gain {
            return Err("this board has no receive gain");
        }
        self.settings = *settings;
        Ok(())
    }

    fn save(&mut self) -> Result<Saving, Failure> {
        self.stored = Some(self.settings);
        self.saves += 1;
        Ok(Saving::Done)
    }

    fn load(&mut self) -> Result<(), Failure> {
        self.settings = self.stored.ok_or("nothing is stored")?;
        Ok(())
    }

    fn identity(&self) -> Identity<'_> {
        Identity {
            device: "adsbee_1090",
            version: "0.1.0.0 (Nov 25 2026)",
            serial: match self.settings.serial.as_str() {
                "" => "0123456789ABCDEF",
                serial => serial,
            },
        }
    }

    fn baud_rates(&self) -> BaudRates {
        BaudRates {
            comms_uart: self.settings.comms_baud,
            gnss_uart: self.settings.gnss_baud,
        }
    }

    fn uptime_s(&self) -> u32 {
        134
    }

    fn rx_gain(&mut self) -> Result<u8, Failure> {
        if self.has_gain {
            Ok(self.settings.rx_gain)
        } else {
            Err("this board has no receive gain")
        }
    }

    fn trigger_levels(&mut self) -> Result<(Option<u16>, u16), Failure> {
        Ok((None, self.settings.tl_hi_mv))
    }

    fn usb_drive_allowed(&mut self) -> &mut bool {
        &mut self.usb_drive
    }

    fn tell(&mut self, report: Report, prefix: &str, out: &mut dyn Out) -> Result<(), Failure> {
        match report {
            Report::Stats => out.line(format_args!("{prefix}STATS=DEVICE,uptime_s=134")),
            Report::Gnss => out.line(format_args!("{prefix}GNSS=fix,0")),
            Report::Info => out.line(format_args!("Slot A: 0.1.0.0, confirmed")),
            Report::Test => {
                let result = if self.broken.is_some() {
                    "FAIL"
                } else {
                    "PASS"
                };
                out.line(format_args!("EEPROM: {result}"));
                return self.broken.map_or(Ok(()), Err);
            }
        }
        Ok(())
    }
}
