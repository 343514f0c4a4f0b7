//! What is known of an aircraft when one of its Comm-B replies comes: plain values, passed in by whoever keeps them.
//!
//! All are of the last seconds. The position is not among them: no register decoded here tells one.

use super::bds17::GicbCapability;
use crate::altitude::AltitudeFt;
use crate::angle::CentiDegrees;
use crate::me::identification::Callsign;

/// What is known; `None` where nothing is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// Pressure altitude. A DF20 brings its own.
    pub altitude: Option<AltitudeFt>,
    /// Ground speed, knots.
    pub ground_speed_kt: Option<u16>,
    /// Track over the ground.
    pub track: Option<CentiDegrees>,
    /// Heading, of any north.
    pub heading: Option<CentiDegrees>,
    /// Indicated airspeed, knots.
    pub indicated_airspeed_kt: Option<u16>,
    /// True airspeed, knots.
    pub true_airspeed_kt: Option<u16>,
    /// Mach number in thousandths.
    pub mach_thousandths: Option<u16>,
    /// Vertical rate of any source, feet a minute.
    pub vertical_rate_fpm: Option<i16>,
    /// Callsign.
    pub callsign: Option<Callsign>,
    /// The registers that its register 1,7 has announced.
    pub announced: Option<GicbCapability>,
}

impl Known {
    /// Nothing at all.
    pub const NOTHING: Known = Known {
        altitude: None,
        ground_speed_kt: None,
        track: None,
        heading: None,
        indicated_airspeed_kt: None,
        true_airspeed_kt: None,
        mach_thousandths: None,
        vertical_rate_fpm: None,
        callsign: None,
        announced: None,
    };
}
