//! Our CPR against the peers': each new even or odd message with the last opposite one of the same aircraft, and with the place
//! last found. No time limit between the halves: arithmetic must agree on any pair, true or not.

use crate::ledger::{Difference, Ledger, Peer, Subject};
use crate::view::Said;
use crate::{peer_adsb_deku, peer_rs1090};
use adsb_deku::adsb::ME as AdsbMe;
use adsb_deku::{Altitude, DF as AdsbDf};
use mode_s::{Body, Cpr, CprFormat, CprKind, Frame, Me, Message, Parity, Position, cpr};
use rs1090::decode::DF as Rs1090Df;
use rs1090::decode::adsb::ME as Rs1090Me;
use rs1090::decode::bds::bds05::AirbornePosition;
use rs1090::decode::bds::bds06::SurfacePosition;
use rs1090::decode::cpr as their_cpr;
use std::collections::HashMap;

/// One half of a pair, as each decoder holds it.
#[derive(Clone, Copy)]
struct Half {
    ours: Cpr,
    rs1090: AirbornePosition,
    adsb_deku: Option<Altitude>,
}

/// The last halves and the last place of each address.
#[derive(Default)]
pub struct Pairs {
    halves: HashMap<(u32, bool), Half>,
    found: HashMap<u32, Position>,
}

impl Pairs {
    /// Takes a frame.
    pub fn hear(&mut self, ledger: &mut Ledger, frame: &Frame, message: &Message) {
        let (Parity::Exact(address), Body::ExtendedSquitter { me, .. }) =
            (message.parity, message.body)
        else {
            return;
        };
        let ours = match me {
            Me::AirbornePosition(position) => position.cpr,
            Me::SurfacePosition(position) => position.cpr,
            _ => None,
        };
        let (Some(ours), Some(me)) = (ours, rs1090_me(frame)) else {
            return;
        };
        let address = address.bits();
        match (ours.kind, me) {
            (CprKind::Airborne, Rs1090Me::BDS05 { inner, .. }) => {
                let half = Half {
                    ours,
                    rs1090: inner,
                    adsb_deku: adsb_deku_altitude(frame),
                };
                self.airborne(ledger, frame, address, half);
            }
            (CprKind::Surface, Rs1090Me::BDS06 { inner, .. }) => {
                self.surface(ledger, frame, address, ours, &inner);
            }
            _ => panic!("{frame:?} is a position of another kind to rs1090"),
        }
    }

    fn airborne(&mut self, ledger: &mut Ledger, frame: &Frame, address: u32, half: Half) {
        let is_odd = half.ours.format == CprFormat::Odd;
        if let Some(&near) = self.found.get(&address) {
            let ours = cpr::local(half.ours, near);
            let theirs = their_cpr::airborne_position_with_reference(
                &half.rs1090,
                degrees(near.latitude),
                degrees(near.longitude),
            );
            let theirs = theirs.map(|place| (place.latitude, place.longitude));
            note(
                ledger,
                Peer::Rs1090,
                Subject::LocalPlace,
                frame,
                ours,
                theirs,
            );
        }
        if let Some(other) = self.halves.get(&(address, !is_odd)) {
            let ours = cpr::global(other.ours, half.ours, None);
            let theirs = their_cpr::airborne_position(&other.rs1090, &half.rs1090);
            let theirs = theirs.map(|place| (place.latitude, place.longitude));
            note(
                ledger,
                Peer::Rs1090,
                Subject::GlobalPlace,
                frame,
                ours,
                theirs,
            );
            if let (Some(a), Some(b)) = (other.adsb_deku, half.adsb_deku) {
                let theirs = adsb_deku::cpr::get_position((&a, &b));
                let theirs = theirs.map(|place| (place.latitude, place.longitude));
                note(
                    ledger,
                    Peer::AdsbDeku,
                    Subject::GlobalPlace,
                    frame,
                    ours,
                    theirs,
                );
            }
            if let Some(found) = ours {
                self.found.insert(address, found);
            }
        }
        self.halves.insert((address, is_odd), half);
    }

    fn surface(
        &mut self,
        ledger: &mut Ledger,
        frame: &Frame,
        address: u32,
        ours: Cpr,
        theirs: &SurfacePosition,
    ) {
        // An aircraft that never flew in the log is compared near a place of our choice: the arithmetic is the same anywhere.
        let near = self
            .found
            .get(&address)
            .copied()
            .unwrap_or(SURFACE_REFERENCE);
        let theirs = their_cpr::surface_position_with_reference(
            theirs,
            degrees(near.latitude),
            degrees(near.longitude),
        );
        let theirs = theirs.map(|place| (place.latitude, place.longitude));
        let ours = cpr::local(ours, near);
        note(
            ledger,
            Peer::Rs1090,
            Subject::LocalPlace,
            frame,
            ours,
            theirs,
        );
    }
}

/// 51.990, 4.375: the reference of the surface vector in "The 1090 Megahertz Riddle".
const SURFACE_REFERENCE: Position = Position {
    latitude: 519_900_000,
    longitude: 43_750_000,
};

fn note(
    ledger: &mut Ledger,
    peer: Peer,
    subject: Subject,
    frame: &Frame,
    ours: Option<Position>,
    theirs: Option<(f64, f64)>,
) {
    let difference = Difference {
        peer,
        subject,
        ours: place(ours.map(|at| (degrees(at.latitude), degrees(at.longitude)))),
        theirs: place(theirs),
        frame,
    };
    ledger.compare(is_same_place(ours, theirs), difference);
}

/// A place as text.
pub fn place(place: Option<(f64, f64)>) -> Said {
    place.map_or(Said::Nothing, |(latitude, longitude)| {
        Said::Text(format!("{latitude:.7} {longitude:.7}"))
    })
}

/// Whether a place of ours is theirs rounded to 1e-7 degrees.
pub fn is_same_place(ours: Option<Position>, theirs: Option<(f64, f64)>) -> bool {
    match (ours, theirs) {
        (None, None) => true,
        (Some(ours), Some((latitude, longitude))) => {
            let east = (degrees(ours.longitude) - longitude + 540.0).rem_euclid(360.0) - 180.0;
            (degrees(ours.latitude) - latitude).abs() < ROUNDING && east.abs() < ROUNDING
        }
        _ => false,
    }
}

/// Half of 1e-7 degrees, and what `f64` loses on the way.
const ROUNDING: f64 = 0.51e-7;

/// Degrees of 1e-7 degrees.
pub fn degrees(angle: i32) -> f64 {
    f64::from(angle) / 1e7
}

fn rs1090_me(frame: &Frame) -> Option<Rs1090Me> {
    match peer_rs1090::message(frame)?.df {
        Rs1090Df::ExtendedSquitterADSB(squitter) => Some(squitter.message),
        Rs1090Df::ExtendedSquitterTisB { cf, .. } => Some(cf.me),
        _ => None,
    }
}

fn adsb_deku_altitude(frame: &Frame) -> Option<Altitude> {
    let me = match peer_adsb_deku::read(frame)?.df {
        AdsbDf::ADSB(squitter) => squitter.me,
        AdsbDf::TisB { cf, .. } => cf.me,
        _ => return None,
    };
    match me {
        AdsbMe::AirbornePositionBaroAltitude { altitude, .. }
        | AdsbMe::AirbornePositionGNSSAltitude { altitude, .. } => Some(altitude),
        _ => None,
    }
}
