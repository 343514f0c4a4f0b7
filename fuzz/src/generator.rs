//! Steps that reach deep: frames with right parity of a few hundred aircraft, some of which fly along their encoded positions; the same with wrong
//! bits; noise; times that stand still, jump and go back.

use crate::Step;
use crate::dice::Dice;
use mode_s::{Df, Icao, Position, crc24, nl};
use tracker::RxPosition;

/// Addresses in use: more than the tracker has places for.
const AIRCRAFT: usize = 500;

/// An aircraft that flies.
#[derive(Clone, Copy)]
struct Flight {
    address: u32,
    latitude: f64,
    longitude: f64,
    on_surface: bool,
}

/// Makes steps.
pub struct Generator {
    dice: Dice,
    now_ms: u64,
    flights: Vec<Flight>,
    last: Vec<u8>,
}

impl Generator {
    /// Of these dice.
    pub fn new(mut dice: Dice) -> Generator {
        let flights = (0..AIRCRAFT)
            .map(|_| Flight {
                address: (dice.next() >> 40) as u32,
                latitude: dice.below(180_000) as f64 / 1e3 - 90.0,
                longitude: dice.below(360_000) as f64 / 1e3 - 180.0,
                on_surface: dice.one_in(5),
            })
            .collect();
        Generator {
            dice,
            now_ms: 0,
            flights,
            last: vec![0; 7],
        }
    }

    /// The next step and its time.
    pub fn step(&mut self) -> (u64, Step) {
        self.pass_time();
        let step = match self.dice.below(1_000) {
            0..=7 => Step::Second,
            8..=27 => Step::ModeAc(self.dice.next() as u16),
            28 => Step::Rx(self.receiver()),
            _ => Step::Bytes(self.bytes()),
        };
        (self.now_ms, step)
    }

    fn pass_time(&mut self) {
        let dice = &mut self.dice;
        self.now_ms = match dice.below(200_000) {
            // Any time at all, past or future.
            0 => dice.next(),
            // Up to ten minutes on, or a few seconds back.
            1..=20 => self.now_ms.saturating_add(dice.below(600_000)),
            21..=40 => self.now_ms.saturating_sub(dice.below(10_000)),
            // Near the ends of 16 and 32 bits of time.
            41 => (self.now_ms | 0x3_FFFF).saturating_add(dice.below(8)),
            42 => (self.now_ms | 0xFFFF_FFFF).saturating_add(dice.below(8)),
            // Mostly the channel's own pace and rest.
            n if n % 4 == 0 => self.now_ms.saturating_add(dice.below(10)),
            _ => self.now_ms,
        };
    }

    fn receiver(&mut self) -> RxPosition {
        let dice = &mut self.dice;
        let place = Position {
            latitude: (dice.below(1_800_000_001) as i64 - 900_000_000) as i32,
            longitude: (dice.below(3_600_000_000) as i64 - 1_800_000_000) as i32,
        };
        match dice.below(12) {
            0 => RxPosition::Fixed(place),
            1 => RxPosition::Gnss(Some(place)),
            2 => RxPosition::Gnss(None),
            3 => RxPosition::Lowest,
            4 => RxPosition::Icao(Icao(
                self.flights[dice.below(AIRCRAFT as u64) as usize].address,
            )),
            _ => RxPosition::None,
        }
    }

    fn bytes(&mut self) -> Vec<u8> {
        let made = match self.dice.below(100) {
            0..=9 => self.noise(),
            10..=54 => self.position(),
            55..=74 => self.squitter(),
            75..=89 => self.reply(),
            // The last frame again, or nearly.
            90..=93 => self.last.clone(),
            94..=96 => self.mutated(false),
            97..=98 => self.mutated(true),
            _ => {
                let length = self.dice.below(20) as usize;
                (0..length).map(|_| self.dice.next() as u8).collect()
            }
        };
        if made.len() >= 7 {
            self.last.clone_from(&made);
        }
        made
    }

    /// Random bits of the right length.
    fn noise(&mut self) -> Vec<u8> {
        let first = self.dice.next() as u8;
        let length = if Df::of_first_byte(first).is_long() {
            14
        } else {
            7
        };
        let mut bytes: Vec<u8> = (0..length).map(|_| self.dice.next() as u8).collect();
        bytes[0] = first;
        bytes
    }

    fn flight(&mut self) -> usize {
        // A few are heard often, so that their places are confirmed.
        let among = if self.dice.one_in(3) {
            AIRCRAFT as u64
        } else {
            12
        };
        self.dice.below(among) as usize
    }

    fn address(&mut self) -> u32 {
        if self.dice.one_in(200) {
            return if self.dice.one_in(2) { 0 } else { 0xFF_FFFF };
        }
        let flight = self.flight();
        self.flights[flight].address
    }

    /// The next position of an aircraft, mostly true.
    fn position(&mut self) -> Vec<u8> {
        let index = self.flight();
        let dice = &mut self.dice;
        let flight = &mut self.flights[index];
        if dice.one_in(2_000) {
            flight.latitude = dice.below(180_000) as f64 / 1e3 - 90.0;
            flight.longitude = dice.below(360_000) as f64 / 1e3 - 180.0;
        }
        flight.latitude =
            (flight.latitude + (dice.below(101) as f64 - 50.0) * 1e-6).clamp(-90.0, 90.0);
        flight.longitude = (flight.longitude + (dice.below(101) as f64 - 50.0) * 1e-6 + 540.0)
            .rem_euclid(360.0)
            - 180.0;
        let flight = *flight;
        let is_odd = dice.one_in(2);
        let (latitude, longitude) = encode(flight, is_odd);
        let type_code = if flight.on_surface {
            5 + dice.below(4)
        } else {
            9 + dice.below(10)
        };
        let mut me = type_code << 51 | u64::from(is_odd) << 34 | latitude << 17 | longitude;
        // Whatever stands between type code and position.
        me |= (dice.next() & 0xFFFF) << 35;
        let first = match dice.below(20) {
            0 => 0x92,
            1 => 0x96,
            2 => 0x91,
            3 => 0x98,
            _ => 0x8D,
        };
        self.with_parity(first, flight.address, me)
    }

    /// An extended squitter of any content.
    fn squitter(&mut self) -> Vec<u8> {
        let address = self.address();
        let first = match self.dice.below(8) {
            0 => 0x90 | self.dice.below(8) as u8,
            1 => 0x98 | self.dice.below(8) as u8,
            _ => 0x88 | self.dice.below(8) as u8,
        };
        let me = self.dice.next() >> 8;
        // Type codes that mean something come more often.
        let known = [1, 4, 5, 9, 19, 19, 19, 20, 28, 29, 31];
        let me = if self.dice.one_in(2) {
            let type_code = known[self.dice.below(11) as usize];
            me & ((1 << 51) - 1) | type_code << 51
        } else {
            me
        };
        self.with_parity(first, address, me)
    }

    fn with_parity(&mut self, first: u8, address: u32, me: u64) -> Vec<u8> {
        let mut bytes = vec![first];
        bytes.extend(&address.to_be_bytes()[1..]);
        bytes.extend(&me.to_be_bytes()[1..]);
        sealed(bytes, 0)
    }

    /// A reply of an aircraft: all-call, surveillance, Comm-B.
    fn reply(&mut self) -> Vec<u8> {
        let address = self.address();
        let dice = &mut self.dice;
        let [_, a, b, c] = address.to_be_bytes();
        match dice.below(4) {
            0 => {
                let code = if dice.one_in(2) {
                    0
                } else {
                    dice.below(100) as u32
                };
                sealed(vec![0x58 | dice.below(8) as u8, a, b, c], code)
            }
            1 => {
                let df = [0, 4, 5][dice.below(3) as usize];
                let rest = dice.next().to_be_bytes();
                sealed(
                    vec![df << 3 | rest[0] & 7, rest[1], rest[2], rest[3]],
                    address,
                )
            }
            _ => {
                let df = [16, 20, 21, 24][dice.below(4) as usize];
                let mut bytes: Vec<u8> = (0..11).map(|_| dice.next() as u8).collect();
                bytes[0] = df << 3 | bytes[0] & 7;
                let mb = register(dice);
                if df != 24 && dice.one_in(2) {
                    bytes[4..].copy_from_slice(&mb.to_be_bytes()[1..]);
                }
                sealed(bytes, address)
            }
        }
    }

    /// The last frame with wrong bits, with or without a parity that says so.
    fn mutated(&mut self, sealed_again: bool) -> Vec<u8> {
        let mut bytes = self.last.clone();
        for _ in 0..=self.dice.below(3) {
            let bit = self.dice.below(8 * bytes.len() as u64) as usize;
            bytes[bit / 8] ^= 0x80 >> (bit % 8);
        }
        if sealed_again && bytes.len() > 3 {
            bytes.truncate(bytes.len() - 3);
            return sealed(bytes, 0);
        }
        bytes
    }
}

/// The bytes and their parity, exclusive-or'ed with `mask`.
fn sealed(mut bytes: Vec<u8>, mask: u32) -> Vec<u8> {
    let parity = crc24::remainder(&bytes) ^ mask;
    bytes.extend(&parity.to_be_bytes()[1..]);
    bytes
}

/// An MB that some register can have produced: its mark, or fields with their status bits set.
fn register(dice: &mut Dice) -> u64 {
    let random = dice.next() >> 8;
    match dice.below(6) {
        0 => 0x20 << 48 | [0x0820_8208_2082, 0x2CC3_71C3_1DE0][dice.below(2) as usize],
        1 => 0xFA_81C1_0000_0000,
        2 => 0x30 << 48 | random & 0xFFFF_FFFF_FFFF,
        // Selected altitudes in hundreds and 1013 hPa.
        3 => 1 << 55 | (dice.below(400) * 25 / 4) << 43 | 1 << 29 | 2_130 << 17,
        // 5,0 and 6,0 of an airliner.
        4 => 0x80_1939_1536_E024 | random & 0xFF,
        _ => 0x8F_39F9_1A7E_27C4 ^ random & 0xFF,
    }
}

/// Encoded latitude and longitude by the standard's equations.
fn encode(flight: Flight, is_odd: bool) -> (u64, u64) {
    let span = if flight.on_surface { 90.0 } else { 360.0 };
    let steps = |angle: f64, zones: f64| {
        let zone = span / zones;
        (131_072.0 * angle.rem_euclid(zone) / zone).round() as u64 & 0x1_FFFF
    };
    let odd = f64::from(u8::from(is_odd));
    let zones = f64::from(nl::nl((flight.latitude * 1e7) as i32)) - odd;
    (
        steps(flight.latitude, 60.0 - odd),
        steps(flight.longitude, zones.max(1.0)),
    )
}
