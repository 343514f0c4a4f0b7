//! What reports tell beside frames and aircraft: who the device is, and where.

use report::{FrameTimes, Gnss, Moment};
use reporter::Context;
use settings::Settings;

/// What of it is kept here.
pub struct Station {
    /// The flash's unique id.
    pub unique_id: u64,
    /// The GNSS receiver's fix.
    pub gnss: Gnss,
    /// The instant at which the second under way began, of UTC where that is known.
    pub second_began: FrameTimes,
}

impl Station {
    /// All of it at a moment: `version` of the image, `serial` unless the settings have another.
    pub fn context<'a>(
        &'a self,
        version: &'a str,
        serial: &'a str,
        settings: &'a Settings,
        moment: Moment,
    ) -> Context<'a> {
        Context {
            moment,
            second_began: self.second_began,
            gnss: &self.gnss,
            serial: &settings.serial,
            own_serial: serial,
            firmware: version,
            unique_id: self.unique_id,
        }
    }
}
