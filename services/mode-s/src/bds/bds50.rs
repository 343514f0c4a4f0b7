//! Register 5,0: track and turn.
//!
//! ```text
//!   1 2      11 12 13      23 24 25      34 35 36       45 46 47      56
//!   |S| roll   |S | track    |S | speed    |S | turn rate |S | TAS      |
//! ```
//! Roll counts 45/256° in two's complement (positive: right wing down), track 90/512° in two's complement from true north, both speeds
//! 2 kt, the turn rate 1/32° a second in two's complement (positive: to the right). Source: ICAO Doc 9871, table A-2-80, as rs1090
//! documents it.

use super::{Fit, Known, field, signed_field};
use crate::angle::CentiDegrees;
use crate::frame::MeBits;

/// Register 5,0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackAndTurn {
    /// Roll in steps of 45/256°, right wing down positive.
    pub roll_steps: Option<i16>,
    /// True track.
    pub track: Option<CentiDegrees>,
    /// Ground speed, knots.
    pub ground_speed_kt: Option<u16>,
    /// Rate of turn, 32nds of a degree a second, to the right positive.
    pub track_rate_32nds: Option<i16>,
    /// True airspeed, knots.
    pub true_airspeed_kt: Option<u16>,
}

/// Steepest roll of an aircraft that carries passengers, 50° in steps: 50 × 256 / 45.
const STEEPEST_STEPS: i16 = 284;
/// Fastest, knots: Mach 0.95 in a wind of 150 kt.
const FASTEST_KT: u16 = 700;
/// Below it the relation of roll and turn says nothing: the aircraft taxies, knots.
const TAXI_KT: u16 = 50;
/// Strongest wind, knots: jet streams reach 220.
const WIND_KT: u16 = 220;
/// What two speeds a few seconds apart may differ by, and how near they agree, knots.
const SPEED_ROOM_KT: u16 = 60;
const SPEED_AGREES_KT: u16 = 20;
/// The same of two tracks: a standard turn is 3° a second.
const TRACK_ROOM: u16 = 3_500;
const TRACK_AGREES: u16 = 1_000;

impl TrackAndTurn {
    /// Decodes MB as register 5,0.
    pub fn decode(mb: MeBits) -> Option<TrackAndTurn> {
        Some(TrackAndTurn {
            roll_steps: signed_field(mb, 1, 11)?,
            track: field(mb, 12, 23)?.map(CentiDegrees::of_2048ths),
            ground_speed_kt: field(mb, 24, 34)?.map(|steps| steps as u16 * 2),
            track_rate_32nds: signed_field(mb, 35, 45)?,
            true_airspeed_kt: field(mb, 46, 56)?.map(|steps| steps as u16 * 2),
        })
    }

    /// Roll in hundredths of a degree.
    pub const fn roll_centidegrees(&self) -> Option<i16> {
        match self.roll_steps {
            // 4500 / 256, rounded.
            Some(steps) => Some(((steps as i32 * 4_500 + 128) >> 8) as i16),
            None => None,
        }
    }

    /// Its own numbers must belong together, and to the aircraft.
    pub(super) fn fit(&self, known: &Known) -> Fit {
        let steep = |steps: i16| steps.unsigned_abs() > STEEPEST_STEPS as u16;
        let speeds = [self.ground_speed_kt, self.true_airspeed_kt];
        let too_fast = speeds.into_iter().flatten().any(|kt| kt > FASTEST_KT);
        if self.roll_steps.is_some_and(steep) || too_fast {
            return None;
        }
        let mut agreements = self.turn_fits()?;
        if let (Some(ground), Some(air)) = (self.ground_speed_kt, self.true_airspeed_kt) {
            if ground.abs_diff(air) > WIND_KT {
                return None;
            }
            agreements += 1;
        }
        for (told, known, room) in [
            (self.ground_speed_kt, known.ground_speed_kt, SPEED_ROOM_KT),
            (self.true_airspeed_kt, known.true_airspeed_kt, SPEED_ROOM_KT),
            // The wind lies between them.
            (self.true_airspeed_kt, known.ground_speed_kt, WIND_KT),
        ] {
            let (Some(told), Some(known)) = (told, known) else {
                continue;
            };
            let away = told.abs_diff(known);
            if away > room {
                return None;
            }
            if away <= SPEED_AGREES_KT && room == SPEED_ROOM_KT {
                agreements += 2;
            }
        }
        if let (Some(track), Some(known)) = (self.track, known.track) {
            let away = track.away_from(known);
            if away > TRACK_ROOM {
                return None;
            }
            agreements += if away <= TRACK_AGREES { 2 } else { 0 };
        }
        Some(agreements)
    }

    /// Whether roll and rate of turn belong together: rate = 1091° a second × tan(roll) / TAS in knots, for small angles 19 × roll.
    fn turn_fits(&self) -> Fit {
        let (Some(roll), Some(rate), Some(speed)) = (
            self.roll_steps,
            self.track_rate_32nds,
            self.true_airspeed_kt,
        ) else {
            return Some(0);
        };
        if speed < TAXI_KT {
            return Some(0);
        }
        // 19.04 × 45 / 256 × 32 = 107.1 32nds a second for each step of roll and each knot; the tangent adds a third at 50°.
        let expected = i32::from(roll) * 107 / i32::from(speed);
        let away = (expected - i32::from(rate)).abs();
        // A degree a second for lag and rounding, and half of what a steep turn makes.
        if away > 32 + expected.abs() / 2 {
            return None;
        }
        Some(u8::from(away <= 16))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::frame;

    fn published() -> TrackAndTurn {
        // A frame of "The 1090 Megahertz Riddle": roll 2.1°, track 114.258°, 438 kt, 0.125° a second, 424 kt.
        TrackAndTurn::decode(frame("A000139381951536E024D4CCF6B5").me()).unwrap()
    }

    #[test]
    fn a_published_register() {
        let register = published();
        assert_eq!(register.roll_centidegrees(), Some(211));
        assert_eq!(register.track, Some(CentiDegrees(11_426)));
        assert_eq!(register.ground_speed_kt, Some(438));
        assert_eq!(register.track_rate_32nds, Some(4));
        assert_eq!(register.true_airspeed_kt, Some(424));
        assert_eq!(register.fit(&Known::NOTHING), Some(2));
    }

    #[test]
    fn signs() {
        // Roll -1 step, track -90°, rate -1.
        let all = 1u64 << 55 | 0x3FF << 45 | 1 << 44 | 0x600 << 33 | 1 << 21 | 0x3FF << 11;
        let [_, bytes @ ..] = all.to_be_bytes();
        let register = TrackAndTurn::decode(MeBits::new(bytes)).unwrap();
        assert_eq!(register.roll_steps, Some(-1));
        assert_eq!(register.roll_centidegrees(), Some(-18));
        assert_eq!(register.track, Some(CentiDegrees(27_000)));
        assert_eq!(register.track_rate_32nds, Some(-1));
        assert_eq!(register.ground_speed_kt, None);
    }

    #[test]
    fn what_is_known_agrees_or_contradicts() {
        let known = |ground_speed_kt, track| Known {
            ground_speed_kt: Some(ground_speed_kt),
            track: Some(CentiDegrees(track)),
            ..Known::NOTHING
        };
        assert_eq!(published().fit(&known(440, 11_000)), Some(6));
        assert_eq!(published().fit(&known(480, 8_000)), Some(2));
        assert_eq!(published().fit(&known(500, 11_000)), None);
        assert_eq!(published().fit(&known(440, 29_000)), None);
    }

    #[test]
    fn a_turn_against_its_roll_contradicts() {
        let turn = |roll_steps, rate| {
            TrackAndTurn {
                roll_steps: Some(roll_steps),
                track_rate_32nds: Some(rate),
                ..published()
            }
            .fit(&Known::NOTHING)
        };
        // 25° at 424 kt: 1.2° a second.
        assert_eq!(turn(142, 38), Some(2));
        assert_eq!(turn(142, -38), None);
        assert_eq!(turn(285, 70), None);
    }
}
