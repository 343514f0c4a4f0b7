//! Aircraft that fly straight and send extended squitters of where they are.
//!
//! ```text
//!   squitter  0        1         2       3         4 ...  9         10 ...
//!             even     velocity  odd     velocity  even   callsign  even        each aircraft goes round on its own
//! ```
//! Positions by CPR and velocities by subtype 1, as "The 1090 Megahertz Riddle" gives them; whole numbers where a receiver sees them, so the same on
//! every host.

use super::traffic::{df11, df17, surveillance};
use super::{Content, Emission, Role};
use crate::front_end::decibel;
use crate::source::random::Random;
use mode_s::{Frame, nl};
use std::f64::consts::TAU;

/// Squitters of one round, the last of which is the callsign.
const ROUND: u64 = 10;
/// Knots a degree of latitude an hour.
const KNOTS_A_DEGREE: f64 = 60.0;
/// Seconds an hour, picoseconds a second.
const SECONDS_AN_HOUR: f64 = 3600.0;
const PS_A_SECOND: f64 = 1e12;
/// Squawk 1200 as its pulses stand in DF5 (A1 and B2 alone).
const SQUAWK_1200: u16 = 0x0808;
/// Counts of CPR in a zone of the airborne encoding.
const CPR_COUNTS: f64 = 131_072.0;

/// The address of the transmitter with this number: spread over all 24 bits, never zero.
pub fn address_of(number: usize) -> u32 {
    ((number as u32).wrapping_mul(2_654_435_761) >> 8) | 1
}

/// One aircraft at the scene's start.
#[derive(Clone, Debug)]
pub struct Aircraft {
    pub number: usize,
    pub latitude: f64,
    pub longitude: f64,
    pub altitude_ft: i32,
    pub speed_kt: f64,
    /// Clockwise from north, radians.
    pub track: f64,
    /// Level at the antenna, dBm.
    pub dbm: f32,
    sent: u64,
}

impl Aircraft {
    /// So many of them within two degrees of a place, levels between two.
    pub fn fleet(seed: u64, count: usize, place: (f64, f64), dbm: (f32, f32)) -> Vec<Self> {
        let mut random = Random::new(seed ^ 0x4149_5243);
        let mut draw = move |from: f64, to: f64| from + (to - from) * random.unit();
        (0..count)
            .map(|number| Self {
                number,
                latitude: place.0 + draw(-2.0, 2.0),
                longitude: place.1 + draw(-2.0, 2.0),
                altitude_ft: (draw(80.0, 1600.0) as i32) * 25,
                speed_kt: draw(150.0, 500.0),
                track: draw(0.0, TAU),
                dbm: draw(f64::from(dbm.0), f64::from(dbm.1)) as f32,
                sent: 0,
            })
            .collect()
    }

    /// Where it is so long after the start, degrees.
    pub fn place(&self, at_ps: u64) -> (f64, f64) {
        let hours = at_ps as f64 / PS_A_SECOND / SECONDS_AN_HOUR;
        let degrees = self.speed_kt * hours / KNOTS_A_DEGREE;
        let (east, north) = decibel::sin_cos(self.track);
        let narrow = decibel::sin_cos(self.latitude.to_radians()).1.max(0.01);
        (
            self.latitude + degrees * north,
            self.longitude + degrees * east / narrow,
        )
    }

    /// Its next squitter.
    pub fn squitter(&mut self, at_ps: u64) -> Emission {
        let number = self.sent % ROUND;
        self.sent += 1;
        Emission {
            at_ps,
            transmitter: self.number,
            dbm: self.dbm,
            content: Content::ModeS(self.frame(number, at_ps)),
            role: Role::Wanted,
        }
    }

    /// What it sends next if it has no ADS-B: DF11, DF4, DF0 and DF5 in turn.
    pub fn reply(&mut self) -> Frame {
        let address = address_of(self.number);
        let number = self.sent % 4;
        self.sent += 1;
        match number {
            0 => df11(address),
            1 => surveillance(4, address, self.altitude_code()),
            2 => surveillance(0, address, self.altitude_code()),
            _ => surveillance(5, address, SQUAWK_1200),
        }
    }

    /// AC of 13 bits in steps of 25 ft: the steps' bits around M (0) and Q (1).
    fn altitude_code(&self) -> u16 {
        let steps = ((self.altitude_ft + 1000) / 25) as u16;
        (steps & 0x7E0) << 2 | (steps & 0x10) << 1 | 0x10 | steps & 0xF
    }

    fn frame(&self, number: u64, at_ps: u64) -> Frame {
        let me = if number == ROUND - 1 {
            self.callsign()
        } else if number % 2 == 1 {
            self.velocity()
        } else {
            self.position(at_ps, number % 4 == 2)
        };
        df17(address_of(self.number), me)
    }

    /// Type code 11: barometric altitude, CPR.
    fn position(&self, at_ps: u64, odd: bool) -> u64 {
        let (latitude, longitude) = self.place(at_ps);
        let (y, x) = cpr(latitude, longitude, odd);
        let count = ((self.altitude_ft + 1000) / 25) as u64;
        let altitude = (count & 0x7F0) << 1 | 0x10 | count & 0xF;
        11 << 51 | altitude << 36 | u64::from(odd) << 34 | y << 17 | x
    }

    /// Type code 19, subtype 1: over ground, in knots; level flight.
    fn velocity(&self) -> u64 {
        let (east, north) = decibel::sin_cos(self.track);
        let part = |knots: f64| u64::from(knots < 0.0) << 10 | (knots.abs().round() as u64 + 1);
        let (east, north) = (part(self.speed_kt * east), part(self.speed_kt * north));
        // NACv 2; vertical rate 0, from the barometer; no difference to the GNSS height.
        19 << 51 | 1 << 48 | 2 << 43 | east << 32 | north << 21 | 1 << 20 | 1 << 10
    }

    /// Type code 4, category 3: `SQ` and its number.
    fn callsign(&self) -> u64 {
        let text = format!("SQ{:<6}", self.number);
        let codes = text.bytes().take(8);
        codes.fold(4 << 3 | 3, |me, byte| me << 6 | u64::from(byte & 0x3F))
    }
}

/// CPR of an airborne position: latitude and longitude counts.
fn cpr(latitude: f64, longitude: f64, odd: bool) -> (u64, u64) {
    let zones = if odd { 59.0 } else { 60.0 };
    let height = 360.0 / zones;
    let counts = |angle: f64, zone: f64| {
        let share = angle.rem_euclid(zone) / zone;
        (share * CPR_COUNTS + 0.5).floor()
    };
    let y = counts(latitude, height);
    let seen = height * (y / CPR_COUNTS + (latitude / height).floor());
    let columns = i32::from(nl::nl((seen * 1e7).round() as i32)) - i32::from(odd);
    let x = counts(longitude, 360.0 / f64::from(columns.max(1)));
    (y as u64 & 0x1_FFFF, x as u64 & 0x1_FFFF)
}

/// Squitters of these aircraft in turn, one every `spacing_ps`, for ever.
pub struct InTurn {
    aircraft: Vec<Aircraft>,
    next: usize,
    at_ps: u64,
    spacing_ps: u64,
}

impl InTurn {
    pub fn new(aircraft: Vec<Aircraft>, spacing_ps: u64) -> Self {
        Self {
            aircraft,
            next: 0,
            at_ps: 0,
            spacing_ps,
        }
    }
}

impl Iterator for InTurn {
    type Item = Emission;

    fn next(&mut self) -> Option<Emission> {
        let count = self.aircraft.len();
        let emission = self.aircraft.get_mut(self.next)?.squitter(self.at_ps);
        self.next = (self.next + 1) % count;
        self.at_ps += self.spacing_ps;
        Some(emission)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mode_s::{Body, HorizontalVelocity, Me, Message, cpr as decode};

    fn fleet() -> Vec<Aircraft> {
        Aircraft::fleet(5, 50, (52.4, 13.5), (-80.0, -60.0))
    }

    fn me(me: u64) -> Me {
        match Message::decode(&df17(1, me)).body {
            Body::ExtendedSquitter { me, .. } => me,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_pair_of_positions_decodes_to_where_the_aircraft_is() {
        for one in fleet() {
            let [even, odd] = [false, true].map(|odd| match me(one.position(0, odd)) {
                Me::AirbornePosition(position) => position,
                other => panic!("{other:?}"),
            });
            let cpr = |p: mode_s::AirbornePosition| p.cpr.expect("a position");
            let place = decode::global(cpr(even), cpr(odd), None).expect("a place");
            assert!((f64::from(place.latitude) * 1e-7 - one.latitude).abs() < 1e-4);
            assert!((f64::from(place.longitude) * 1e-7 - one.longitude).abs() < 2e-4);
            let altitude = even.altitude.expect("an altitude").altitude;
            assert_eq!(altitude.0, one.altitude_ft);
        }
    }

    #[test]
    fn velocity_and_callsign_are_its_own() {
        for one in fleet() {
            let Me::Velocity(velocity) = me(one.velocity()) else {
                panic!("no velocity");
            };
            let Some(HorizontalVelocity::Ground { speed_kt, .. }) = velocity.horizontal else {
                panic!("{velocity:?}");
            };
            assert!((f64::from(speed_kt) - one.speed_kt).abs() < 1.5);
            let Me::Identification(identification) = me(one.callsign()) else {
                panic!("no identification");
            };
            let callsign = identification.callsign.expect("a callsign");
            let text = format!("SQ{}", one.number);
            assert_eq!(callsign.as_bytes().trim_ascii_end(), text.as_bytes());
        }
    }

    #[test]
    fn addresses_differ() {
        let all: std::collections::HashSet<u32> = (0..1000).map(address_of).collect();
        assert!(all.len() >= 999 && !all.contains(&0));
    }
}
