//! The emergency code that GDL90 and ASTERIX share with ADS-B: 0 none, 1 general, 2 medical, 3 minimum fuel, 4 no communications,
//! 5 unlawful interference, 6 downed.

use mode_s::{EmergencyState, ModeACode};
use tracker::Aircraft;

/// What an aircraft says of it: its emergency state where fresh, else what its squawk means.
pub(crate) fn code(aircraft: &Aircraft, now_ms: u64) -> u8 {
    match aircraft.emergency(now_ms) {
        None | Some(EmergencyState::None | EmergencyState::Reserved) => {
            aircraft.squawk().map_or(0, of_squawk)
        }
        Some(state) => state.code(),
    }
}

/// What the three squawks that mean an emergency mean.
pub(crate) fn of_squawk(squawk: ModeACode) -> u8 {
    match squawk {
        ModeACode(0o7500) => 5,
        ModeACode(0o7600) => 4,
        ModeACode(0o7700) => 1,
        _ => 0,
    }
}
