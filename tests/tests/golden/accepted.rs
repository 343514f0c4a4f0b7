//! The differences that are understood and stay: a line each with its reason, and how often it occurs in the long flight and in the
//! lax log. A count that moves fails the test, as a difference without a line does.

use crate::ledger::{Accepted, Difference, Peer, Subject};
use crate::tracked::{REFUSED, WAITING};
use crate::view::{Field, Said};
use mode_s::parity::HIGHEST_INTERROGATOR_CODE;
use mode_s::{AltitudeFt, Body, Me};

/// Every accepted difference.
pub static ACCEPTED: &[Accepted] = &[
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 takes any DF11; codes end at 79 (Annex 10 IV: CL 0-4), so a larger residual is a broken frame here",
        applies: |d| {
            d.subject == Subject::Taken
                && d.frame.df().number() == 11
                && d.frame.residual() > HIGHEST_INTERROGATOR_CODE
        },
        counts: [4, 53],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 reads an AC field with M = 1 as an altitude; here it has a name of its own; those of the log are noise",
        applies: |d| d.is_of(Field::Altitude) && is_metric(d),
        counts: [0, 27],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 reads a TIS-B velocity as one of ADS-B: its IFR and NACv are NACp, its difference NACv and SIL (DO-260B 2.2.17.3.4)",
        applies: |d| {
            is_of_tisb_velocity(d, &[Field::IfrCapable, Field::Nacv, Field::GnssMinusBaro])
        },
        counts: [0, 45],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku reads a TIS-B velocity as one of ADS-B: its NACv is part of NACp, its GNSS-baro difference NACv and SIL",
        applies: |d| is_of_tisb_velocity(d, &[Field::Nacv, Field::GnssMinusBaro]),
        counts: [0, 25],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 reads a speed component of code 0 as -1 kt; 0 is \"no information\", and here there is no ground speed",
        applies: |d| {
            (d.is_of(Field::GroundSpeed) || d.is_of(Field::Track)) && is_velocity_without_speed(d)
        },
        counts: [0, 4],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 reads source bit 0 of the vertical rate as barometric; \"The 1090 Megahertz Riddle\" has 0 GNSS, 1 barometer",
        applies: is_inverted_source,
        counts: [10450, 25120],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 reads GNSS-baro code 1 as none; the code less one is the value, so 1 is 0 ft",
        applies: is_zero_difference,
        counts: [205, 20],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 prints # for a character that means nothing; here such a callsign is none",
        applies: is_meaningless_callsign,
        counts: [2, 0],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 shows the first pair's place; the tracker waits for one more message of each format that agrees",
        applies: |d| d.subject == Subject::TrackedPlace && d.ours == Said::Text(WAITING.to_owned()),
        counts: [2, 778],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 shows a place 130 km off the track, from a frame with right parity and wrong content, and an ADS-R target whose only two messages lie 1.15 km apart; the tracker refuses both",
        applies: |d| d.subject == Subject::TrackedPlace && d.ours == Said::Text(REFUSED.to_owned()),
        counts: [0, 2],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "the tracker follows a take-off from the surface; rs1090 was asked for airborne places alone and waits for a pair",
        applies: |d| {
            d.subject == Subject::TrackedPlace
                && d.theirs == Said::Nothing
                && d.ours != Said::Text(WAITING.to_owned())
        },
        counts: [1, 0],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 cannot read DF24; here it is a format that is counted and not decoded",
        applies: |d| {
            d.subject == Subject::Taken && d.frame.df().number() == 24 && d.theirs == Said::Whole(0)
        },
        counts: [0, 7],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku reads source bit 0 of the vertical rate as barometric, as rs1090 does, which began as its fork",
        applies: is_inverted_source,
        counts: [10450, 25120],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku gives 0 for GNSS-baro codes 0 and 1 alike, which stands for none",
        applies: is_zero_difference,
        counts: [205, 20],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku has no sign for altitudes: at or below 0 ft it gives none",
        applies: |d| {
            (d.is_of(Field::Altitude) || d.is_of(Field::AltitudeSource))
                && d.theirs == Said::Nothing
                && altitude(d).is_some_and(|feet| feet.0 <= 0)
        },
        counts: [0, 2],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku keeps altitudes in 16 bits: from 65 536 ft they wrap",
        applies: |d| {
            d.is_of(Field::Altitude)
                && d.theirs.number() == altitude(d).map(|feet| f64::from(feet.0 - 65_536))
        },
        counts: [2, 1],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku prints # for a character that means nothing; here such a callsign is none",
        applies: is_meaningless_callsign,
        counts: [1, 0],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku reads seven of a callsign's eight characters",
        applies: |d| match (&d.ours, &d.theirs) {
            (Said::Text(ours), Said::Text(theirs)) => {
                d.is_of(Field::Callsign) && ours.len() == 8 && ours[..7] == **theirs
            }
            _ => false,
        },
        counts: [1, 0],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku reads two of the movement's seven bits, so all that follows in a surface position is shifted by five",
        applies: |d| {
            [
                Field::Track,
                Field::UtcSynchronised,
                Field::CprIsOdd,
                Field::CprLatitude,
                Field::CprLongitude,
            ]
            .iter()
            .any(|&field| d.is_of(field))
                && matches!(me(d), Some(Me::SurfacePosition(_)))
        },
        counts: [10548, 3],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku gives a place for halves in different longitude zone counts; here, and in rs1090, they give none",
        applies: |d| d.subject == Subject::GlobalPlace && d.ours == Said::Nothing,
        counts: [10, 6],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku reads the source bit of a selected altitude as the altitude's highest bit: FMS adds 65 536 ft",
        applies: |d| {
            d.is_of(Field::SelectedAltitude)
                && d.ours.number().map(|feet| feet + 65_536.0) == d.theirs.number()
        },
        counts: [3, 0],
    },
    Accepted {
        peer: Peer::AdsbDeku,
        reason: "adsb_deku reads a selected altitude of code 1 as none; the code less one is the value, so 1 is 0 ft",
        applies: |d| d.is_of(Field::SelectedAltitude) && is_selected_at_zero(d),
        counts: [0, 41],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "rs1090 reads a selected altitude of code 1 as none; the code less one is the value, so 1 is 0 ft",
        applies: |d| d.is_of(Field::SelectedByFms) && is_selected_at_zero(d),
        counts: [0, 41],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "register 4,0: rs1090 rounds selected altitudes to hundreds of feet; here, as in pyModeS, they are the steps of 16 ft sent",
        applies: |d| {
            let name = [
                Subject::Register("selected_mcp"),
                Subject::Register("selected_fms"),
            ];
            let away = |(ours, theirs): (f64, f64)| (ours - theirs).abs();
            name.contains(&d.subject)
                && d.ours
                    .number()
                    .zip(d.theirs.number())
                    .map(away)
                    .is_some_and(|feet| feet <= 50.0)
        },
        counts: [9108, 174],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "register 5,0: rs1090 takes -1 step of the turn rate for none; it is a number in two's complement (Doc 9871), and pyModeS reads it",
        applies: |d| {
            d.subject == Subject::Register("track_rate")
                && d.ours == Said::Real(-0.031_25)
                && d.theirs == Said::Nothing
        },
        counts: [1570, 22],
    },
    Accepted {
        peer: Peer::Rs1090,
        reason: "register 6,0: rs1090 takes -1 step of a vertical rate for 0; it is -32 ft/min in two's complement, and pyModeS reads it",
        applies: |d| {
            let name = [
                Subject::Register("vrate_barometric"),
                Subject::Register("vrate_inertial"),
            ];
            name.contains(&d.subject) && d.ours == Said::Whole(-32) && d.theirs == Said::Real(0.0)
        },
        counts: [3593, 36],
    },
];

/// The ME field, where our decoder reads one.
fn me(d: &Difference) -> Option<Me> {
    match d.message().body {
        Body::ExtendedSquitter { me, .. } => Some(me),
        _ => None,
    }
}

/// The altitude that our decoder reads.
fn altitude(d: &Difference) -> Option<AltitudeFt> {
    match d.message().body {
        Body::AirAir { altitude, .. } | Body::AltitudeReply { altitude, .. } => altitude,
        Body::ExtendedSquitter {
            me: Me::AirbornePosition(position),
            ..
        } => position.altitude.map(|altitude| altitude.altitude),
        _ => None,
    }
}

/// An AC field of 13 bits with M = 1.
fn is_metric(d: &Difference) -> bool {
    matches!(d.frame.df().number(), 0 | 4 | 16 | 20) && d.frame.bytes()[3] & 0x40 != 0
}

fn is_of_tisb_velocity(d: &Difference, fields: &[Field]) -> bool {
    fields.iter().any(|&field| d.is_of(field)) && matches!(me(d), Some(Me::TisbVelocity(_)))
}

fn is_velocity_without_speed(d: &Difference) -> bool {
    let velocity = match me(d) {
        Some(Me::Velocity(velocity)) => velocity,
        Some(Me::TisbVelocity(told)) => told.velocity,
        _ => return false,
    };
    velocity.horizontal.is_none()
}

fn is_inverted_source(d: &Difference) -> bool {
    d.is_of(Field::VerticalRateIsBarometric)
        && match (&d.ours, &d.theirs) {
            (Said::Whole(ours), Said::Whole(theirs)) => ours + theirs == 1,
            _ => false,
        }
}

fn is_zero_difference(d: &Difference) -> bool {
    d.is_of(Field::GnssMinusBaro) && d.ours == Said::Whole(0) && d.theirs == Said::Nothing
}

fn is_meaningless_callsign(d: &Difference) -> bool {
    d.is_of(Field::Callsign)
        && d.ours == Said::Nothing
        && matches!(&d.theirs, Said::Text(text) if text.contains('#'))
}

/// A target state whose selected altitude has code 1, which a peer takes for none.
fn is_selected_at_zero(d: &Difference) -> bool {
    // Bits 10-20 of ME.
    let [_, second, third, ..] = d.frame.bytes()[4..] else {
        return false;
    };
    (u16::from(second & 0x7F) << 4 | u16::from(third >> 4)) == 1 && d.theirs == Said::Nothing
}
