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

/// 95 % of horizontal errors lie within so many standard deviations of one axis, tenths.
const RADIUS_95_TENTHS: u32 = 25;
/// EPU bounds of NACp 11 to 1, centimetres: 3 m, 10 m, 30 m, 0.05, 0.1, 0.3, 0.5, 1, 2, 4 and 10 NM (DO-260B).
const EPU_CM: [u32; 11] = [
    300, 1_000, 3_000, 9_260, 18_520, 55_560, 92_600, 185_200, 370_400, 740_800, 1_852_000,
];

impl Gnss {
    /// NACp of the reported accuracy: 95 % of errors below EPU.
    pub fn nac_p(&self) -> Option<u8> {
        let error = self.latitude_error_cm?.max(self.longitude_error_cm?);
        let radius = error.saturating_mul(RADIUS_95_TENTHS) / 10;
        let worse = EPU_CM.iter().filter(|&&bound| radius >= bound).count();
        Some(11 - worse as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nacp_by_the_worse_axis() {
        let with = |latitude_error_cm, longitude_error_cm| {
            Gnss {
                latitude_error_cm,
                longitude_error_cm,
                ..Gnss::default()
            }
            .nac_p()
        };
        assert_eq!(with(None, Some(10)), None);
        assert_eq!(with(Some(119), Some(10)), Some(11));
        assert_eq!(with(Some(10), Some(120)), Some(10));
        assert_eq!(with(Some(u32::MAX), Some(1)), Some(0));
    }
}
