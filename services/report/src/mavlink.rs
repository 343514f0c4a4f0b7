//! MAVLink 1 and 2: aircraft for autopilots and ground stations.
//!
//! ```text
//!   v1  FE length sequence system component message              payload               checksum, low byte first
//!   v2  FD length 0 0      sequence system component message ×3  payload, zeros at its end left out    checksum
//!   a second: ADSB_VEHICLE (246) for each aircraft, MESSAGE_INTERVAL (244) as the end of the list, HEARTBEAT (0) beside them
//! ```
//! ADSB_VEHICLE, its fields in the order on the wire:
//!
//! | bytes | field | unit | unknown |
//! |---|---|---|---|
//! | 0-3 | ICAO_address | | |
//! | 4-11 | lat, lon | 1e-7 degrees | 0, VALID_COORDS clear |
//! | 12-15 | altitude | mm | 0, VALID_ALTITUDE clear |
//! | 16-17 | heading: track over the ground | 0.01° | 0, VALID_HEADING clear |
//! | 18-19 | hor_velocity | cm/s | 0, VALID_VELOCITY clear |
//! | 20-21 | ver_velocity, up positive | cm/s | 0, VERTICAL_VELOCITY_VALID clear |
//! | 22-23 | flags | | |
//! | 24-25 | squawk as decimal digits: 7700 is 7700 | | 0, VALID_SQUAWK clear |
//! | 26 | altitude_type: 0 pressure, 1 geometric | | 0 |
//! | 27-35 | callsign, padded with NUL | | NUL, VALID_CALLSIGN clear |
//! | 36 | emitter_type | | 0 |
//! | 37 | tslc | s | at most 255 |
//!
//! The checksum is X.25's over all but the first byte, and over a byte that stands for the message's definition. Written by hand: three
//! fixed layouts take fewer bytes of flash than the crate's codec; the tests have pymavlink read them back.
//!
//! Source: the MAVLink guide (serialization, checksum) and `common.xml`; the vectors in this file's tests.

use crate::Full;
use crate::altitude_order::AltitudeOrder;
use crate::ecat;
use crate::moment::Moment;
use crate::units::{cm_s_of_eighths, cm_s_of_fpm, millimetres};
use tracker::Aircraft;

/// Bytes of an ADSB_VEHICLE payload.
const VEHICLE_BYTES: usize = 38;
/// A slice that holds any of our messages.
pub const MAX_MESSAGE: usize = 10 + VEHICLE_BYTES + 2;

/// Microseconds between bursts, as MESSAGE_INTERVAL tells them.
const INTERVAL_US: i32 = 1_000_000;

/// Message number, and the byte for its definition (CRC_EXTRA).
#[derive(Clone, Copy)]
struct Kind(u8, u8);

const HEARTBEAT: Kind = Kind(0, 50);
const MESSAGE_INTERVAL: Kind = Kind(244, 95);
const ADSB_VEHICLE: Kind = Kind(246, 184);

/// ADSB_FLAGS.
mod flag {
    pub const COORDINATES: u16 = 1;
    pub const ALTITUDE: u16 = 2;
    pub const HEADING: u16 = 4;
    pub const VELOCITY: u16 = 8;
    pub const CALLSIGN: u16 = 16;
    pub const SQUAWK: u16 = 32;
    pub const VERTICAL_VELOCITY: u16 = 128;
    pub const BAROMETRIC: u16 = 256;
}

/// Framing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Version {
    /// Every parser reads it.
    #[default]
    V1,
    /// Zeros at the end of a payload are left out.
    V2,
}

/// One port's stream: who sends, and how many messages it has sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// Framing.
    pub version: Version,
    /// System id.
    pub system: u8,
    /// Component id; 156 is MAV_COMP_ID_ADSB.
    pub component: u8,
    /// Sequence number of the next message.
    pub sequence: u8,
}

impl Default for Link {
    fn default() -> Link {
        Link {
            version: Version::V1,
            system: 1,
            component: 156,
            sequence: 0,
        }
    }
}

impl Link {
    /// ADSB_VEHICLE of one aircraft.
    pub fn vehicle(
        &mut self,
        aircraft: &Aircraft,
        moment: &Moment,
        order: AltitudeOrder,
        out: &mut [u8],
    ) -> Result<usize, Full> {
        self.message(ADSB_VEHICLE, &vehicle(aircraft, moment, order), out)
    }

    /// MESSAGE_INTERVAL: the list of aircraft has ended.
    pub fn interval(&mut self, out: &mut [u8]) -> Result<usize, Full> {
        let [a, b, c, d] = INTERVAL_US.to_le_bytes();
        self.message(MESSAGE_INTERVAL, &[a, b, c, d, ADSB_VEHICLE.0, 0], out)
    }

    /// HEARTBEAT: an ADS-B receiver is there and works.
    pub fn heartbeat(&mut self, out: &mut [u8]) -> Result<usize, Full> {
        // custom_mode 0; MAV_TYPE_ADSB, MAV_AUTOPILOT_INVALID, base_mode 0, MAV_STATE_ACTIVE, MAVLink 3 in both framings.
        self.message(HEARTBEAT, &[0, 0, 0, 0, 27, 8, 0, 4, 3], out)
    }

    fn message(&mut self, kind: Kind, payload: &[u8], out: &mut [u8]) -> Result<usize, Full> {
        let Kind(number, extra) = kind;
        let (system, component, sequence) = (self.system, self.component, self.sequence);
        let payload = match self.version {
            Version::V1 => payload,
            Version::V2 => trimmed(payload),
        };
        let length = payload.len() as u8;
        let v1 = [0xFE, length, sequence, system, component, number];
        let v2 = [
            0xFD, length, 0, 0, sequence, system, component, number, 0, 0,
        ];
        let head: &[u8] = match self.version {
            Version::V1 => &v1,
            Version::V2 => &v2,
        };
        let mut crc = 0xFFFF;
        let mut places = out.iter_mut();
        let mut put = |byte| places.next().map(|place| *place = byte).ok_or(Full);
        for (index, &byte) in head.iter().chain(payload).enumerate() {
            put(byte)?;
            if index > 0 {
                crc = x25(crc, byte);
            }
        }
        let [low, high] = x25(crc, extra).to_le_bytes();
        put(low)?;
        put(high)?;
        self.sequence = sequence.wrapping_add(1);
        Ok(head.len() + payload.len() + 2)
    }
}

/// The payload without zeros at its end; the first byte always stays.
fn trimmed(payload: &[u8]) -> &[u8] {
    let last = payload.iter().rposition(|&byte| byte != 0).unwrap_or(0);
    &payload[..=last]
}

/// One byte further in the X.25 checksum.
fn x25(crc: u16, byte: u8) -> u16 {
    let mixed = byte ^ crc as u8;
    let mixed = u16::from(mixed ^ mixed << 4);
    crc >> 8 ^ mixed << 8 ^ mixed << 3 ^ mixed >> 4
}

/// Fields one after the other, low byte first.
struct Payload {
    bytes: [u8; VEHICLE_BYTES],
    length: usize,
}

impl Payload {
    fn put(&mut self, bytes: &[u8]) {
        let places = self.bytes.iter_mut().skip(self.length);
        places.zip(bytes).for_each(|(place, &byte)| *place = byte);
        self.length += bytes.len();
    }
}

fn vehicle(aircraft: &Aircraft, moment: &Moment, order: AltitudeOrder) -> [u8; VEHICLE_BYTES] {
    let now_ms = moment.now_ms;
    let position = aircraft.position(now_ms);
    let altitude = order.pick(aircraft, now_ms);
    let track = aircraft.track(now_ms);
    let speed = aircraft.ground_speed_eighths(now_ms);
    let rate = aircraft.vertical_rate(now_ms);
    let (callsign, squawk) = (aircraft.callsign(), aircraft.squawk());
    let flags = [
        (position.is_some(), flag::COORDINATES),
        (altitude.is_some(), flag::ALTITUDE),
        (altitude.is_some_and(|a| !a.is_geometric), flag::BAROMETRIC),
        (track.is_some(), flag::HEADING),
        (speed.is_some(), flag::VELOCITY),
        (rate.is_some(), flag::VERTICAL_VELOCITY),
        (callsign.is_some(), flag::CALLSIGN),
        (squawk.is_some(), flag::SQUAWK),
    ];
    let flags = flags
        .iter()
        .filter(|(is_set, _)| *is_set)
        .fold(0, |all, (_, flag)| all | flag);
    let speed_cm_s = speed.map_or(0, cm_s_of_eighths).min(u16::MAX.into()) as u16;
    let digits = squawk.map_or([0; 4], |code| code.digits());
    let squawk = digits.iter().fold(0, |all, &d| all * 10 + u16::from(d));
    let mut payload = Payload {
        bytes: [0; VEHICLE_BYTES],
        length: 0,
    };
    payload.put(&aircraft.address().bits().to_le_bytes());
    payload.put(&position.map_or(0, |p| p.latitude).to_le_bytes());
    payload.put(&position.map_or(0, |p| p.longitude).to_le_bytes());
    payload.put(&altitude.map_or(0, |a| millimetres(a.feet)).to_le_bytes());
    payload.put(&track.map_or(0, |t| t.0).to_le_bytes());
    payload.put(&speed_cm_s.to_le_bytes());
    let climb = rate.map_or(0, |rate| cm_s_of_fpm(rate.feet_per_minute));
    payload.put(&climb.to_le_bytes());
    payload.put(&flags.to_le_bytes());
    payload.put(&squawk.to_le_bytes());
    payload.put(&[altitude.is_some_and(|a| a.is_geometric).into()]);
    let mut name = [0; 9];
    if let Some(callsign) = callsign {
        let places = name.iter_mut().zip(callsign.as_bytes());
        places.for_each(|(place, &byte)| *place = byte);
    }
    payload.put(&name);
    let silent_s = (aircraft.silent_ms(now_ms) / 1_000).min(u8::MAX.into()) as u8;
    payload.put(&[aircraft.category().map_or(0, ecat::mavlink), silent_s]);
    payload.bytes
}

#[cfg(test)]
#[path = "mavlink_tests.rs"]
mod tests;
