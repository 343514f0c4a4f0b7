//! What an aircraft's fields say to one who guesses which register a Comm-B reply of it copies.

use crate::aircraft::Aircraft;
use crate::field::Field;
use mode_s::Known;

/// How old a value may be that a register is compared with, ms: the room given there is for some seconds.
const FRESH_MS: u32 = 10_000;

impl Aircraft {
    /// What is known of the aircraft now.
    pub fn known(&self, now_ms: u64) -> Known {
        let is_fresh = |field| self.freshness.is_within(field, FRESH_MS, now_ms);
        Known {
            altitude: is_fresh(Field::BaroAltitude).then_some(self.baro_altitude),
            ground_speed_kt: is_fresh(Field::GroundSpeed)
                .then_some((self.ground_speed_eighths + 4) / 8),
            track: is_fresh(Field::Track).then_some(self.track),
            heading: is_fresh(Field::Heading).then_some(self.heading),
            indicated_airspeed_kt: is_fresh(Field::IndicatedAirspeed)
                .then_some(self.indicated_airspeed_kt),
            true_airspeed_kt: is_fresh(Field::TrueAirspeed).then_some(self.true_airspeed_kt),
            mach_thousandths: is_fresh(Field::Mach).then_some(self.mach),
            vertical_rate_fpm: is_fresh(Field::VerticalRate).then_some(self.vertical_rate_fpm),
            callsign: self.callsign(),
            announced: self.announced(),
        }
    }
}
