//! What an aircraft's fields say to one who guesses which register a Comm-B reply of it copies.

use crate::aircraft::Aircraft;
use mode_s::Known;

/// How old a value may be that a register is compared with, ms: the room given there is for some seconds.
const FRESH_MS: u32 = 10_000;

impl Aircraft {
    /// What is known of the aircraft now.
    pub fn known(&self, now_ms: u64) -> Known {
        let airspeed = self.airspeed.within(FRESH_MS, now_ms);
        let speed = |is_true| {
            airspeed
                .filter(|speed| speed.is_true == is_true)
                .map(|speed| speed.knots)
        };
        Known {
            altitude: self.baro_altitude.within(FRESH_MS, now_ms),
            ground_speed_kt: self
                .ground_speed
                .within(FRESH_MS, now_ms)
                .map(|eighths| (eighths + 4) / 8),
            track: self.track.within(FRESH_MS, now_ms),
            heading: self.heading.within(FRESH_MS, now_ms),
            indicated_airspeed_kt: speed(false),
            true_airspeed_kt: speed(true),
            vertical_rate_fpm: self
                .vertical_rate
                .within(FRESH_MS, now_ms)
                .map(|rate| rate.feet_per_minute),
            callsign: self.callsign.last(),
            ..Known::NOTHING
        }
    }
}
