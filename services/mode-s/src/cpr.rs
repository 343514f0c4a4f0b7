//! Compact position reporting: 17 bits each of latitude and longitude, and the way back to degrees.
//!
//! The globe is cut into 60 (even) or 59 (odd) latitude zones; a message gives only the place inside a zone. An even and an odd
//! message of one place together tell the zones ("global"); a place known to be near tells them alone ("local"). On the surface the
//! zones are four times smaller, so a global pair leaves one of two latitudes and one of four longitudes, and the nearest to a
//! reference holds.
//!
//! All arithmetic is exact in `i64` and is rounded once, to 1e-7 degrees (11 mm). A CPR quantum is 4.6e-5 degrees of latitude in
//! the air (5.1 m), a quarter of it on the surface.
//!
//! Range of the local way: within half a zone of the reference, so 180 NM in the air and 45 NM on the surface.
//! Source: the equations as "The 1090 Megahertz Riddle" prints them.

use crate::nl::nl;

/// Bits of a CPR coordinate.
const BITS: u32 = 17;
/// Steps inside a zone.
const STEPS: i64 = 1 << BITS;
/// 360° in 1e-7 degrees.
const TURN: i64 = 3_600_000_000;
/// 90° in 1e-7 degrees.
const QUARTER_TURN: i64 = TURN / 4;

/// 360° in 1e-7 degrees, and 90°, without their factors of two.
const UNITS_A_SPAN: i32 = 3_515_625;

/// A place: degrees × 1e7, north and east positive, longitude in [-180°, 180°).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Latitude in 1e-7 degrees.
    pub latitude: i32,
    /// Longitude in 1e-7 degrees.
    pub longitude: i32,
}

/// Even or odd: which zones the message used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CprFormat {
    /// F = 0: 60 latitude zones.
    Even,
    /// F = 1: 59 latitude zones.
    Odd,
}

/// Size of the zones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CprKind {
    /// Zones of about 6°.
    Airborne,
    /// Zones of about 1.5°.
    Surface,
}

/// The encoded position of one message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cpr {
    /// Zone size.
    pub kind: CprKind,
    /// Even or odd.
    pub format: CprFormat,
    /// YZ, 17 bits.
    pub latitude: u32,
    /// XZ, 17 bits.
    pub longitude: u32,
}

impl CprKind {
    /// What 60 even latitude zones span, 1e-7 degrees.
    const fn span(self) -> i64 {
        match self {
            CprKind::Airborne => TURN,
            CprKind::Surface => QUARTER_TURN,
        }
    }
}

impl CprFormat {
    /// The i of the equations.
    const fn index(self) -> i64 {
        match self {
            CprFormat::Even => 0,
            CprFormat::Odd => 1,
        }
    }
}

/// Place of `latest` from an even and an odd message of one kind, in either order.
///
/// `None` where the two are not one of each, lie in different longitude zone counts (the aircraft crossed a step of NL between
/// them) or give no latitude; and for surface messages without a reference.
pub fn global(previous: Cpr, latest: Cpr, reference: Option<Position>) -> Option<Position> {
    let (even, odd) = match (previous.format, latest.format) {
        (CprFormat::Even, CprFormat::Odd) => (previous, latest),
        (CprFormat::Odd, CprFormat::Even) => (latest, previous),
        _ => return None,
    };
    if even.kind != odd.kind {
        return None;
    }
    let kind = latest.kind;
    let reference = match kind {
        CprKind::Airborne => None,
        CprKind::Surface => Some(reference?),
    };

    let zone = (59 * i64::from(even.latitude) - 60 * i64::from(odd.latitude) + STEPS / 2) >> BITS;
    let south_or_north = |cpr: Cpr| {
        let zones = 60 - cpr.format.index();
        let angle = place(kind.span(), zones, zone_number(zone, zones), cpr.latitude);
        match reference {
            None if angle >= 3 * QUARTER_TURN => angle - TURN,
            None => angle,
            Some(near) => nearest_quarter(angle, near.latitude),
        }
    };
    let even_latitude = checked_latitude(south_or_north(even))?;
    let odd_latitude = checked_latitude(south_or_north(odd))?;
    let zones = nl(even_latitude);
    if zones != nl(odd_latitude) {
        return None;
    }
    let latitude = match latest.format {
        CprFormat::Even => even_latitude,
        CprFormat::Odd => odd_latitude,
    };

    let nl = i64::from(zones);
    let zone =
        (i64::from(even.longitude) * (nl - 1) - i64::from(odd.longitude) * nl + STEPS / 2) >> BITS;
    let zones = (nl - latest.format.index()).max(1);
    let mut longitude = place(
        kind.span(),
        zones,
        zone_number(zone, zones),
        latest.longitude,
    );
    if let Some(near) = reference {
        longitude = nearest_quarter(longitude, near.longitude);
    }
    Some(Position {
        latitude,
        longitude: wrapped_longitude(longitude),
    })
}

/// Place of a message known to lie within half a zone of `near`. `None` where it gives no latitude.
pub fn local(cpr: Cpr, near: Position) -> Option<Position> {
    let span = cpr.kind.span();
    let zones = 60 - cpr.format.index();
    let latitude = nearest(span, zones, cpr.latitude, i64::from(near.latitude));
    let latitude = checked_latitude(latitude)?;
    let zones = (i64::from(nl(latitude)) - cpr.format.index()).max(1);
    let longitude = nearest(span, zones, cpr.longitude, i64::from(near.longitude));
    Some(Position {
        latitude,
        longitude: wrapped_longitude(longitude),
    })
}

/// Number of a zone, 0 to `zones` - 1, of one counted past either end. At most 60 either way.
fn zone_number(zone: i64, zones: i64) -> i64 {
    i64::from((zone as i32).rem_euclid(zones as i32))
}

/// Of the solutions 90° apart that a surface pair leaves, the nearest to `near`.
fn nearest_quarter(angle: i64, near: i32) -> i64 {
    let mut angle = angle;
    while angle - i64::from(near) >= QUARTER_TURN / 2 {
        angle -= QUARTER_TURN;
    }
    while angle - i64::from(near) < -QUARTER_TURN / 2 {
        angle += QUARTER_TURN;
    }
    angle
}

/// Angle at `steps` inside zone number `zone` of `zones` zones that span `span`, rounded to nearest.
fn place(span: i64, zones: i64, zone: i64, steps: u32) -> i64 {
    // span (zone 2^17 + steps) / (zones 2^17), and half a unit; floors of floors are the floor of all.
    let in_zones = (span * ((zone << BITS) + i64::from(steps)) + (zones << (BITS - 1))) >> BITS;
    floor_div(in_zones, zones as u32)
}

/// The same in the zone that puts it nearest to `near`.
fn nearest(span: i64, zones: i64, steps: u32, near: i64) -> i64 {
    let in_zones = near * zones;
    // Both spans are UNITS_A_SPAN times a power of two, so the quotient needs 32 bits alone.
    let shift = span.trailing_zeros();
    let zone = i64::from(((in_zones >> shift) as i32).div_euclid(UNITS_A_SPAN));
    // What is left, and the steps, as parts of a zone in units of span / 2^17: half a zone apart or more is another zone.
    let left = (in_zones - zone * span) << BITS;
    let (steps_in, half) = (span * i64::from(steps), span << (BITS - 1));
    let zone = if left - steps_in >= half {
        zone + 1
    } else if left - steps_in < -half {
        zone - 1
    } else {
        zone
    };
    place(span, zones, zone, steps)
}

/// Floor of `value / by`, where `by` is a number of zones and the result an angle: two divisions of 32 bits, where one of 64 costs the
/// processor a thousand cycles.
fn floor_div(value: i64, by: u32) -> i64 {
    // Makes the value positive: no angle is below -2^33 units.
    const LIFT: i64 = 1 << 33;
    let lifted = value + LIFT * i64::from(by);
    let (high, low) = ((lifted >> 16) as u32, lifted as u32 & 0xFFFF);
    let rest = (high % by) << 16 | low;
    (i64::from(high / by) << 16) + i64::from(rest / by) - LIFT
}

fn checked_latitude(latitude: i64) -> Option<i32> {
    (latitude.abs() <= QUARTER_TURN).then_some(latitude as i32)
}

fn wrapped_longitude(longitude: i64) -> i32 {
    // At most a turn away: places beside the date line, and solutions of a surface pair beyond it.
    let longitude = if longitude >= TURN / 2 {
        longitude - TURN
    } else if longitude < -TURN / 2 {
        longitude + TURN
    } else {
        longitude
    };
    longitude as i32
}

#[cfg(test)]
#[path = "cpr_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "cpr_reference_tests.rs"]
mod reference_tests;
