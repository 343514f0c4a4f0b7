//! Which altitude GDL90 and MAVLink put into their one field.

use mode_s::AltitudeFt;
use tracker::Aircraft;

/// `SUBPROTOCOL`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AltitudeOrder {
    /// 0: the geometric one where known.
    GeometricFirst,
    /// 1: the pressure altitude where known.
    #[default]
    BarometricFirst,
}

/// An altitude and what it was measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Altitude {
    pub feet: i32,
    pub is_geometric: bool,
}

impl AltitudeOrder {
    /// The altitude to tell.
    pub(crate) fn pick(self, aircraft: &Aircraft, now_ms: u64) -> Option<Altitude> {
        let told = |altitude: Option<AltitudeFt>, is_geometric| {
            altitude.map(|AltitudeFt(feet)| Altitude { feet, is_geometric })
        };
        let geometric = told(aircraft.gnss_altitude(now_ms), true);
        let barometric = told(aircraft.baro_altitude(now_ms), false);
        match self {
            AltitudeOrder::GeometricFirst => geometric.or(barometric),
            AltitudeOrder::BarometricFirst => barometric.or(geometric),
        }
    }
}
