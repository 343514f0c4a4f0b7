//! Airborne velocity (TC 19, BDS 0,9): over the ground (subtypes 1, 2) or through the air (3, 4), and climb.
//!
//! ```text
//!   1    6  9  10  11   14           25           36 37       47 49       56
//!   | TC |ST|IC|IFR|NACv|W| east-west |S| north-south |src|s|rate|  |s| GNSS-baro |    ST 1, 2
//!                       |H| heading   |T| airspeed    |                                ST 3, 4
//! ```
//! IC: the intent has changed (reserved from version 2 on). IFR: able to fly by ADS-B under instrument rules (reserved from version 2 on).
//! The highest code of a field stands for its value and more: 1022 or 4088 kt, 32 640 ft/min, 3150 ft.
//! Subtypes 2 and 4 are supersonic: speeds in steps of 4 kt. In every field 0 means "not available" and 1 means zero, so the value is
//! the field less one. src: 0 GNSS, 1 barometric. Source: "The 1090 Megahertz Riddle", airborne velocity.

use crate::angle::CentiDegrees;
use crate::frame::MeBits;

/// Speed through the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Airspeed {
    /// Knots.
    pub knots: u16,
    /// True airspeed; otherwise indicated.
    pub is_true: bool,
}

/// What the horizontal part of the message tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HorizontalVelocity {
    /// Over the ground.
    Ground {
        /// Ground speed in knots, rounded.
        speed_kt: u16,
        /// Track; none at rest.
        track: Option<CentiDegrees>,
    },
    /// Through the air.
    Air {
        /// Magnetic heading by the standard, where known.
        heading: Option<CentiDegrees>,
        /// Airspeed, where known.
        airspeed: Option<Airspeed>,
    },
}

/// Climb or descent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VerticalRate {
    /// Feet a minute, up positive, in steps of 64.
    pub feet_per_minute: i16,
    /// From pressure altitude; otherwise from GNSS.
    pub is_barometric: bool,
}

/// TC 19, subtypes 1-4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Velocity {
    /// Subtype, 1-4.
    pub subtype: u8,
    /// IC: the intent has changed.
    pub intent_change: bool,
    /// IFR: able to fly by ADS-B under instrument rules.
    pub ifr_capable: bool,
    /// NACv (NUCr in version 0), 0-7 as sent.
    pub nacv: u8,
    /// Speed and direction; `None` where a component is missing.
    pub horizontal: Option<HorizontalVelocity>,
    /// Vertical rate, where known.
    pub vertical_rate: Option<VerticalRate>,
    /// GNSS height less pressure altitude in feet, where known, in steps of 25.
    pub gnss_minus_baro_ft: Option<i16>,
}

impl Velocity {
    /// Decodes an ME field of TC 19, subtypes 1-4.
    pub fn decode(me: MeBits) -> Velocity {
        let subtype = me.bits(6, 8);
        let step = if subtype.is_multiple_of(2) { 4 } else { 1 };
        Velocity {
            subtype: subtype as u8,
            intent_change: me.bit(9),
            ifr_capable: me.bit(10),
            nacv: me.bits(11, 13) as u8,
            horizontal: if subtype <= 2 {
                over_ground(me, step)
            } else {
                through_air(me, step)
            },
            vertical_rate: signed(me, 37, 46).map(|steps| VerticalRate {
                feet_per_minute: (steps * 64) as i16,
                is_barometric: me.bit(36),
            }),
            gnss_minus_baro_ft: signed(me, 49, 56).map(|steps| (steps * 25) as i16),
        }
    }
}

/// A sign bit `sign` followed by a magnitude plus one up to bit `last`.
fn signed(me: MeBits, sign: usize, last: usize) -> Option<i32> {
    let magnitude = me.bits(sign + 1, last).checked_sub(1)? as i32;
    Some(if me.bit(sign) { -magnitude } else { magnitude })
}

fn over_ground(me: MeBits, step: i32) -> Option<HorizontalVelocity> {
    let east = signed(me, 14, 24)? * step;
    let north = signed(me, 25, 35)? * step;
    Some(HorizontalVelocity::Ground {
        speed_kt: length(east, north),
        track: CentiDegrees::of_vector(east, north),
    })
}

/// Length of a vector of components up to 4088, rounded to nearest.
fn length(east: i32, north: i32) -> u16 {
    let squared = (east * east + north * north) as u32;
    ((4 * squared).isqrt().div_ceil(2)) as u16
}

fn through_air(me: MeBits, step: i32) -> Option<HorizontalVelocity> {
    // 1024 steps of 0.3515625°.
    let heading = me
        .bit(14)
        .then(|| CentiDegrees(((me.bits(15, 24) * 36_000 + 512) / 1024) as u16));
    let airspeed = me.bits(26, 35).checked_sub(1).map(|steps| Airspeed {
        knots: steps as u16 * step as u16,
        is_true: me.bit(25),
    });
    (heading.is_some() || airspeed.is_some())
        .then_some(HorizontalVelocity::Air { heading, airspeed })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_is_rounded_to_nearest() {
        for east in 0..200 {
            for north in 0..200 {
                let formula = f64::from(east).hypot(f64::from(north)).round() as u16;
                assert_eq!(length(east, north), formula, "{east} {north}");
            }
        }
        assert_eq!(length(-4088, 4088), 5781);
    }

    #[test]
    fn intent_change_and_ifr_capability_stand_in_bits_9_and_10() {
        for (second, intent, ifr) in [(0x80, true, false), (0x40, false, true)] {
            let velocity = Velocity::decode(MeBits::new([19 << 3 | 1, second, 0, 0, 0, 0, 0]));
            assert_eq!(velocity.intent_change, intent);
            assert_eq!(velocity.ifr_capable, ifr);
            assert_eq!((velocity.subtype, velocity.nacv), (1, 0));
        }
    }

    #[test]
    fn supersonic_speeds_count_four_knots() {
        // ST 2, 101 east (one step less), 1 north.
        let mut me = [19 << 3 | 2, 0, 0, 0, 0, 0, 0];
        me[2] = 101;
        me[4] = 1 << 5;
        assert_eq!(
            Velocity::decode(MeBits::new(me)).horizontal,
            Some(HorizontalVelocity::Ground {
                speed_kt: 400,
                track: Some(CentiDegrees(9000))
            })
        );
    }

    #[test]
    fn a_missing_component_leaves_no_ground_velocity() {
        let mut me = [19 << 3 | 1, 0, 0, 0, 0, 0, 0];
        me[2] = 101;
        let velocity = Velocity::decode(MeBits::new(me));
        assert_eq!(velocity.horizontal, None);
        assert_eq!(velocity.vertical_rate, None);
        assert_eq!(velocity.gnss_minus_baro_ft, None);
    }
}
