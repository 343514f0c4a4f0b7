//! GDL90: traffic and ownship for electronic flight bags.
//!
//! ```text
//!   a second: heartbeat (0), ForeFlight id (65h), ownship (10), its geometric altitude (11), traffic (20) for each aircraft with a position
//!
//!   0   status 1 | status 2 | seconds since UTC midnight, low 16 bits, low byte first | receptions, 10 bits
//!   20  alert,type | address ×3 | latitude ×3 | longitude ×3 | altitude, misc ×2 | NIC,NACp | speed, rate ×3 | track | emitter | callsign ×8 | emergency
//!   10  as 20, of the receiver itself
//!   11  geometric altitude ×2, 5 ft | vertical warning, figure of merit ×2
//!   65h 0 | version 1 | serial ×8 | name ×8 | long name ×16 | capabilities ×4
//! ```
//! | field | unit | unknown |
//! |---|---|---|
//! | latitude, longitude | 180/2^23 degrees, cut off as in the specification's example | no message |
//! | altitude | 25 ft from -1000 ft; pressure altitude first unless SUBPROTOCOL is 0 | FFF |
//! | speed | kt, at most 4094 | FFF |
//! | rate | 64 ft/min, within ±32 640 | 800 |
//! | track | 256ths of a turn; misc says true track, magnetic or true heading | 0, misc 0 |
//! | NIC, NACp | by the tracker, per version | 0 |
//!
//! A message with no content (traffic without a position, altitude without a fix) has the length 0: nothing is to be sent.
//!
//! Source: GDL 90 Data Interface Specification 560-1058-00 Rev A, 3; ForeFlight's "GDL 90 Extended Specification" (ID message).

use crate::Full;
use crate::altitude_order::AltitudeOrder;
use crate::ecat;
use crate::emergency;
use crate::gdl90_frame::framed;
use crate::gnss::Gnss;
use crate::moment::Moment;
use crate::statistics::Statistics;
use crate::units::turn_parts;
use mode_s::Position;
use tracker::{Aircraft, PositionSource};

/// A slice that holds any message: the longest has 39 bytes and a checksum, each perhaps escaped, and two flags.
pub const MAX_MESSAGE: usize = 2 + 2 * (39 + 2);
/// Bytes of reports 10 and 20.
const REPORT_BYTES: usize = 28;

const ID_HEARTBEAT: u8 = 0;
const ID_OWNSHIP: u8 = 10;
const ID_OWNSHIP_ALTITUDE: u8 = 11;
const ID_TRAFFIC: u8 = 20;
const ID_FOREFLIGHT: u8 = 0x65;

/// Altitude, speed: unknown. All ones in twelve bits.
const UNKNOWN_12: u16 = 0xFFF;
/// Rate: unknown.
const RATE_UNKNOWN: u16 = 0x800;
/// Highest and lowest rate that can be told, 64 ft/min.
const MOST_RATE: i32 = 510;
/// Misc: in the air.
const AIRBORNE: u8 = 0b1000;
/// Speed above which an ownship is taken to fly, hundredths of a knot: above any taxiing, below any stall speed of an aeroplane.
const FLYING_CENTIKNOTS: u32 = 4_000;

/// What misc says of the track field.
mod direction {
    pub const NONE: u8 = 0;
    pub const TRUE_TRACK: u8 = 1;
    pub const MAGNETIC_HEADING: u8 = 2;
    pub const TRUE_HEADING: u8 = 3;
}

/// Who the device is, for the ForeFlight message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Device<'a> {
    /// The flash's unique id.
    pub serial: u64,
    /// At most eight bytes are sent.
    pub name: &'a str,
    /// At most sixteen.
    pub long_name: &'a str,
}

/// Heartbeat (0).
pub fn heartbeat(
    gnss: &Gnss,
    statistics: &Statistics,
    moment: &Moment,
    out: &mut [u8],
) -> Result<usize, Full> {
    // GPS position valid (bit 7), initialised (bit 0).
    let status_1 = u8::from(gnss.has_fix) << 7 | 1;
    let seconds = moment.utc_ms.unwrap_or(0) / 1_000;
    let [low, high, bit_16, _] = seconds.to_le_bytes();
    // Bit 16 of the seconds (bit 7), time is UTC (bit 0).
    let status_2 = bit_16 << 7 | u8::from(moment.utc_ms.is_some());
    // Uplink receptions (five bits) are none: this link has no uplinks. Then the others, ten bits.
    let received = statistics.mode_s_frames.unwrap_or(0).min(1_023) as u16;
    let [more, less] = received.to_be_bytes();
    let message = [ID_HEARTBEAT, status_1, status_2, low, high, more, less];
    framed(&message, out)
}

/// Traffic (20); nothing while the aircraft has no position.
pub fn traffic(
    aircraft: &Aircraft,
    moment: &Moment,
    order: AltitudeOrder,
    out: &mut [u8],
) -> Result<usize, Full> {
    let now_ms = moment.now_ms;
    let Some(position) = aircraft.position(now_ms) else {
        return Ok(0);
    };
    let (direction, angle) = direction_of(aircraft, now_ms);
    let airborne = if aircraft.on_ground() == Some(true) {
        0
    } else {
        AIRBORNE
    };
    let rate = aircraft.vertical_rate(now_ms);
    let altitude = order.pick(aircraft, now_ms);
    let report = Report {
        id: ID_TRAFFIC,
        address_type: address_type(aircraft, now_ms),
        address: aircraft.address().bits(),
        position,
        altitude: altitude.map_or(UNKNOWN_12, |a| altitude_field(a.feet)),
        misc: airborne | direction,
        nic: aircraft.nic(now_ms).unwrap_or(0),
        nac_p: aircraft.status(now_ms).map_or(0, |s| s.nac_p()),
        speed: aircraft
            .ground_speed_eighths(now_ms)
            .map_or(UNKNOWN_12, |eighths| (eighths + 4).min(4_094 * 8) / 8),
        rate: rate.map_or(RATE_UNKNOWN, |r| rate_field(r.feet_per_minute.into())),
        angle,
        emitter: aircraft.category().map_or(0, ecat::aero),
        callsign: padded(aircraft.callsign().as_ref().map_or(b"", |c| c.as_bytes())),
        emergency: emergency::code(aircraft, now_ms),
    };
    framed(&report.bytes(), out)
}

/// Ownship (10); without a fix its latitude, longitude and NIC are 0, which means that there is none.
pub fn ownship(gnss: &Gnss, address: u32, out: &mut [u8]) -> Result<usize, Full> {
    let position = gnss.position.filter(|_| gnss.has_fix);
    let fix = position.is_some();
    let speed = gnss.speed_centiknots.filter(|_| fix);
    let track = gnss.track.filter(|_| fix);
    let flies = speed.is_some_and(|speed| speed > FLYING_CENTIKNOTS);
    let report = Report {
        id: ID_OWNSHIP,
        // A self-assigned address where none was given.
        address_type: u8::from(address == 0),
        address,
        position: position.unwrap_or(Position {
            latitude: 0,
            longitude: 0,
        }),
        // Pressure altitude: the receiver has no barometer.
        altitude: UNKNOWN_12,
        misc: u8::from(flies) << 3 | track.map_or(direction::NONE, |_| direction::TRUE_TRACK),
        // No integrity is known of the receiver's GNSS.
        nic: 0,
        nac_p: gnss.nac_p().filter(|_| fix).unwrap_or(0),
        speed: speed.map_or(UNKNOWN_12, |s| ((s + 50) / 100).min(4_094) as u16),
        rate: match gnss.climb_cm_s.filter(|_| fix) {
            // Centimetres a second are 250/127 ft/min.
            Some(cm_s) => rate_field(cm_s.clamp(-40_000, 40_000) * 250 / 127),
            None => RATE_UNKNOWN,
        },
        angle: track.map_or(0, |t| turn_parts(t.0, 8) as u8),
        emitter: 0,
        callsign: padded(b""),
        emergency: 0,
    };
    framed(&report.bytes(), out)
}

/// Ownship geometric altitude (11): height above the ellipsoid; nothing without a fix that has it.
pub fn ownship_altitude(gnss: &Gnss, out: &mut [u8]) -> Result<usize, Full> {
    let Some(centimetres) = gnss.ellipsoid_cm.filter(|_| gnss.has_fix) else {
        return Ok(0);
    };
    // 5 ft are 152.4 cm.
    let steps = (centimetres.clamp(-1_000_000, 4_000_000) * 10).div_euclid(1_524);
    let [high, low] = (steps as i16).to_be_bytes();
    // Two standard deviations hold 95 %, in metres; 7FFF is unknown.
    let merit = gnss
        .height_error_cm
        .map_or(0x7FFF, |cm| (cm.saturating_add(49) / 50).min(0x7EEE) as u16);
    let [merit_high, merit_low] = merit.to_be_bytes();
    let message = [ID_OWNSHIP_ALTITUDE, high, low, merit_high, merit_low];
    framed(&message, out)
}

/// ForeFlight's id message (65h): the device's name, and that geometric altitudes are above the ellipsoid.
pub fn foreflight_id(device: &Device<'_>, out: &mut [u8]) -> Result<usize, Full> {
    let mut message = [0; 39];
    message[..3].copy_from_slice(&[ID_FOREFLIGHT, 0, 1]);
    message[3..11].copy_from_slice(&device.serial.to_be_bytes());
    let put = |places: &mut [u8], text: &str| {
        let places = places.iter_mut().zip(text.as_bytes());
        places.for_each(|(place, &byte)| *place = byte);
    };
    put(&mut message[11..19], device.name);
    put(&mut message[19..35], device.long_name);
    // Capabilities: bit 0 clear, altitudes are above the WGS-84 ellipsoid.
    framed(&message, out)
}

/// What messages 10 and 20 have in common.
struct Report {
    id: u8,
    address_type: u8,
    address: u32,
    position: Position,
    /// Twelve bits.
    altitude: u16,
    /// Four bits.
    misc: u8,
    nic: u8,
    nac_p: u8,
    /// Twelve bits.
    speed: u16,
    /// Twelve bits, two's complement.
    rate: u16,
    angle: u8,
    emitter: u8,
    callsign: [u8; 8],
    emergency: u8,
}

impl Report {
    fn bytes(&self) -> [u8; REPORT_BYTES] {
        let [_, a, b, c] = self.address.to_be_bytes();
        let [_, lat_a, lat_b, lat_c] = semicircles(self.position.latitude).to_be_bytes();
        let [_, lon_a, lon_b, lon_c] = semicircles(self.position.longitude).to_be_bytes();
        let [altitude, misc] = (self.altitude << 4 | u16::from(self.misc)).to_be_bytes();
        let motion = u32::from(self.speed) << 12 | u32::from(self.rate & 0xFFF);
        let [_, motion_a, motion_b, motion_c] = motion.to_be_bytes();
        let head = [
            self.id,
            // Alert status 0: this receiver warns of nothing.
            self.address_type,
            a,
            b,
            c,
            lat_a,
            lat_b,
            lat_c,
            lon_a,
            lon_b,
            lon_c,
            altitude,
            misc,
            self.nic << 4 | self.nac_p & 0xF,
            motion_a,
            motion_b,
            motion_c,
            self.angle,
            self.emitter,
        ];
        let mut bytes = [0; REPORT_BYTES];
        let (front, rest) = bytes.split_at_mut(head.len());
        front.copy_from_slice(&head);
        rest[..8].copy_from_slice(&self.callsign);
        rest[8] = self.emergency << 4;
        bytes
    }
}

/// 180/2^23 degrees in an angle of 1e-7 degrees, cut off towards zero.
fn semicircles(angle: i32) -> i32 {
    // 180e7 is 2^9 × 3 515 625; at most 24 bits, signed.
    ((i64::from(angle) << 14) / 3_515_625) as i32
}

/// Twelve bits of 25 ft from -1000 ft.
fn altitude_field(feet: i32) -> u16 {
    ((feet + 1_000).div_euclid(25)).clamp(0, 0xFFE) as u16
}

/// Twelve bits of 64 ft/min, rounded.
fn rate_field(feet_per_minute: i32) -> u16 {
    let steps = (feet_per_minute + 32).div_euclid(64);
    (steps.clamp(-MOST_RATE, MOST_RATE) & 0xFFF) as u16
}

/// 0 ADS-B with an ICAO address, 1 without, 2 TIS-B with an ICAO address, 3 without.
fn address_type(aircraft: &Aircraft, now_ms: u64) -> u8 {
    let is_radar = aircraft.position_source(now_ms) == Some(PositionSource::Radar);
    u8::from(is_radar) << 1 | u8::from(!aircraft.address().is_icao())
}

/// The track, else the heading, and what it is.
fn direction_of(aircraft: &Aircraft, now_ms: u64) -> (u8, u8) {
    let heading = |is_magnetic| match is_magnetic {
        true => direction::MAGNETIC_HEADING,
        false => direction::TRUE_HEADING,
    };
    let status = aircraft.status(now_ms).unwrap_or_default();
    if let Some(track) = aircraft.track(now_ms) {
        // Some aircraft on the surface send their heading for a track.
        let is_heading = aircraft.on_ground() == Some(true) && status.surface_heading();
        let kind = match is_heading {
            true => heading(status.magnetic_heading()),
            false => direction::TRUE_TRACK,
        };
        return (kind, turn_parts(track.0, 8) as u8);
    }
    match aircraft.heading(now_ms) {
        Some(angle) => (
            heading(aircraft.heading_is_magnetic()),
            turn_parts(angle.0, 8) as u8,
        ),
        None => (direction::NONE, 0),
    }
}

/// Eight bytes, spaces at the end.
fn padded(text: &[u8]) -> [u8; 8] {
    let mut bytes = [b' '; 8];
    let places = bytes.iter_mut().zip(text);
    places.for_each(|(place, &byte)| *place = byte);
    bytes
}

#[cfg(test)]
#[path = "gdl90_tests.rs"]
mod tests;
