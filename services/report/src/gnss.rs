//! What the receiver's own GNSS says: where the receiver is and how it moves.
//!
//! Plain values without a parser: `nmea` reads sentences, `report` tells them. What no sentence has told is `None`.

use mode_s::{CentiDegrees, Position};

/// Position, motion and accuracy. Values stay as last known when the fix is lost; `has_fix` says so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gnss {
    /// The GNSS has a fix now.
    pub has_fix: bool,
    /// Last known position.
    pub position: Option<Position>,
    /// Last known height above the WGS-84 ellipsoid, centimetres.
    pub ellipsoid_cm: Option<i32>,
    /// Last known height above mean sea level, centimetres.
    pub sea_level_cm: Option<i32>,
    /// Track over the ground, true.
    pub track: Option<CentiDegrees>,
    /// Ground speed, hundredths of a knot.
    pub speed_centiknots: Option<u32>,
    /// Vertical speed, centimetres a second, up positive.
    pub climb_cm_s: Option<i32>,
    /// Standard deviation of the latitude, centimetres.
    pub latitude_error_cm: Option<u32>,
    /// Standard deviation of the longitude, centimetres.
    pub longitude_error_cm: Option<u32>,
    /// Standard deviation of the height, centimetres.
    pub height_error_cm: Option<u32>,
}
