//! The tracker against rs1090: after each frame it takes, the aircraft holds what rs1090 read in that frame; and after each position
//! message, the place it shows is the one that rs1090's own tracking shows. rs1090 refuses a step faster than 1 200 km/h even between
//! messages milliseconds apart, where a CPR quantum is that fast; there the arithmetic of rs1090 near its last place is the judge.

use crate::ledger::{Difference, Ledger, Peer, Subject, is_same};
use crate::peer_rs1090;
use crate::places::{degrees, is_same_place, place};
use crate::view::{Field, Said, View};
use mode_s::{Address, Body, Frame, HorizontalVelocity, Icao, Me, Message, Position};
use rs1090::decode::DF;
use rs1090::decode::ICAO;
use rs1090::decode::adsb::ME;
use rs1090::decode::cpr::{AircraftState, airborne_position_with_reference, decode_position};
use std::collections::BTreeMap;
use tracker::{Aircraft, Heard, Outcome, Tracker};

/// Aircraft tracked at once, as in the firmware.
const AIRCRAFT: usize = 400;

/// What stands for our place while the tracker waits for a pair, or for a second one that agrees.
pub const WAITING: &str = "waiting";
/// What stands for our place where the tracker finds a position impossible.
pub const REFUSED: &str = "refused";

/// Our tracker and theirs.
pub struct Tracked {
    ours: Box<Tracker<AIRCRAFT>>,
    theirs: BTreeMap<ICAO, AircraftState>,
    second: u64,
}

impl Tracked {
    pub fn new() -> Tracked {
        Tracked {
            ours: Box::new(Tracker::new()),
            theirs: BTreeMap::new(),
            second: 0,
        }
    }

    /// Takes a frame heard at `at_ms`, and how rs1090 reads it.
    pub fn hear(&mut self, ledger: &mut Ledger, at_ms: u64, frame: &Frame, view: Option<&View>) {
        while self.second < at_ms / 1000 {
            self.second += 1;
            self.ours.each_second(self.second * 1000);
        }
        let message = Message::decode(frame);
        let before = self.ours.counters();
        let outcome = self.ours.on_frame(frame, &message, Heard::at(at_ms));
        let Some(address) = message.address() else {
            return;
        };
        if !matches!(outcome, Outcome::Born | Outcome::Updated) {
            return;
        }
        let aircraft = self.ours.find(address).expect("a frame it took");
        for (&field, theirs) in view.into_iter().flatten() {
            let Some(ours) = holds(aircraft, field, &message, at_ms) else {
                continue;
            };
            if *theirs != Said::Nothing {
                let is_same = is_same(field, &ours, theirs);
                let difference = Difference {
                    peer: Peer::Rs1090,
                    subject: Subject::Tracked(field),
                    ours,
                    theirs: theirs.clone(),
                    frame,
                };
                ledger.compare(is_same, difference);
            }
        }
        if let (Address::Icao(Icao(icao)), true) = (address, has_airborne_place(&message)) {
            let after = self.ours.counters();
            let ours = if after.positions_shown != before.positions_shown {
                Ok(aircraft.position(at_ms).expect("it was shown"))
            } else if after.positions_waiting != before.positions_waiting {
                Err(WAITING)
            } else {
                Err(REFUSED)
            };
            let theirs = their_place(&mut self.theirs, ICAO(icao), at_ms, frame);
            note(ledger, frame, ours, theirs);
        }
    }
}

/// What the tracker holds of a field that the message sets; `None` for fields it does not keep.
fn holds(aircraft: &Aircraft, field: Field, message: &Message, now_ms: u64) -> Option<Said> {
    let is_gnss = matches!(message.body, Body::ExtendedSquitter { me: Me::AirbornePosition(p), .. } if p.type_code >= 20);
    Some(match field {
        Field::Altitude if is_gnss => Said::whole(aircraft.gnss_altitude(now_ms).map(|a| a.0)),
        Field::Altitude => Said::whole(aircraft.baro_altitude(now_ms).map(|a| a.0)),
        Field::Squawk => text(aircraft.squawk().map(|code| format!("{:04o}", code.0))),
        Field::Callsign => text(
            aircraft
                .callsign()
                .map(|callsign| String::from_utf8_lossy(callsign.as_bytes()).replace(' ', "")),
        ),
        Field::Category => Said::whole(aircraft.category().map(|category| category.ca)),
        Field::VerticalStatus => Said::whole(aircraft.on_ground()),
        Field::GroundSpeed => {
            let eighths = aircraft.ground_speed_eighths(now_ms);
            Said::real(eighths.map(|eighths| f64::from(eighths) / 8.0))
        }
        Field::Track => Said::real(aircraft.track(now_ms).map(|a| f64::from(a.0) / 100.0)),
        Field::Heading => Said::real(aircraft.heading(now_ms).map(|a| f64::from(a.0) / 100.0)),
        Field::Airspeed => {
            let is_true = matches!(message.body, Body::ExtendedSquitter { me: Me::Velocity(v), .. } if matches!(v.horizontal, Some(HorizontalVelocity::Air { airspeed: Some(speed), .. }) if speed.is_true));
            Said::whole(if is_true {
                aircraft.true_airspeed_kt(now_ms)
            } else {
                aircraft.indicated_airspeed_kt(now_ms)
            })
        }
        Field::VerticalRate => {
            Said::whole(aircraft.vertical_rate(now_ms).map(|r| r.feet_per_minute))
        }
        Field::Nacv => Said::whole(aircraft.nacv(now_ms)),
        _ => return None,
    })
}

fn text(text: Option<String>) -> Said {
    text.map_or(Said::Nothing, Said::Text)
}

fn has_airborne_place(message: &Message) -> bool {
    matches!(message.body, Body::ExtendedSquitter { me: Me::AirbornePosition(position), .. } if position.cpr.is_some())
}

/// The place rs1090 gives the message.
fn their_place(
    aircraft: &mut BTreeMap<ICAO, AircraftState>,
    icao: ICAO,
    at_ms: u64,
    frame: &Frame,
) -> Option<(f64, f64)> {
    let mut me = match peer_rs1090::message(frame)?.df {
        DF::ExtendedSquitterADSB(squitter) => squitter.message,
        DF::ExtendedSquitterTisB { cf, .. } => cf.me,
        _ => return None,
    };
    decode_position(
        &mut me,
        at_ms as f64 / 1e3,
        &icao,
        aircraft,
        &mut None,
        &None,
    );
    let ME::BDS05 { inner, .. } = me else {
        return None;
    };
    match (inner.latitude, inner.longitude) {
        (Some(latitude), Some(longitude)) => Some((latitude, longitude)),
        _ => {
            let last = aircraft.get(&icao)?.last_position()?;
            let place = airborne_position_with_reference(&inner, last.latitude, last.longitude)?;
            Some((place.latitude, place.longitude))
        }
    }
}

fn note(
    ledger: &mut Ledger,
    frame: &Frame,
    ours: Result<Position, &'static str>,
    theirs: Option<(f64, f64)>,
) {
    let difference = Difference {
        peer: Peer::Rs1090,
        subject: Subject::TrackedPlace,
        ours: match ours {
            Ok(at) => place(Some((degrees(at.latitude), degrees(at.longitude)))),
            Err(why_not) => Said::Text(why_not.to_owned()),
        },
        theirs: place(theirs),
        frame,
    };
    ledger.compare(is_same_place(ours.ok(), theirs), difference);
}
