//! Are the places that the tracker shows true? Judged by hindsight: whole tracks, ours and rs1090's, before and after each place.
//!
//! ```text
//!   log ─┬─► tracker ─► places shown ─┐
//!        └─► rs1090 ──► places shown ─┴─► each place against all others of its aircraft within 20 s: can it have been there?
//!   the same log, seven of eight position messages lost, one of ten left wrong with right parity ─► the same trackers
//!                                                                            each place against the clean run's track
//! ```
//! A place is wrong when the aircraft could not have flown between it and most of the others; "wrong" is asserted to be 0 for us and printed for
//! rs1090. What it is not: the arithmetic of CPR is compared in `places`.

use crate::peer_rs1090;
use crate::places::degrees;
use mode_s::{Address, Body, Frame, Icao, Me, Message, crc24};
use rs1090::decode::DF;
use rs1090::decode::ICAO;
use rs1090::decode::adsb::ME;
use rs1090::decode::cpr::{AircraftState, decode_position};
use std::collections::BTreeMap;
use tests::logs::{Heard, Log};
use tracker::{Outcome, Tracker};

/// Seconds around a place in which other places judge it.
const AROUND_S: f64 = 20.0;
/// Fastest that a judge allows, m/s: 1 000 kt.
const FASTEST_M_S: f64 = 514.0;
/// Allowed beside the flown distance, metres. The times of the lax log are made up, and no transponder's are exact.
const MARGIN_M: f64 = 1_500.0;

/// A place at a time.
#[derive(Clone, Copy)]
struct Place {
    at_s: f64,
    latitude: f64,
    longitude: f64,
}

impl Place {
    /// Metres on a sphere.
    fn metres(&self, other: &Place) -> f64 {
        let (a, b) = (self.latitude.to_radians(), other.latitude.to_radians());
        let east = (self.longitude - other.longitude).to_radians() / 2.0;
        let north = (a - b) / 2.0;
        let h = north.sin().powi(2) + a.cos() * b.cos() * east.sin().powi(2);
        2.0 * 6_371_000.0 * h.sqrt().asin()
    }

    fn can_be(&self, other: &Place) -> bool {
        let flown = (self.at_s - other.at_s).abs() * FASTEST_M_S;
        self.metres(other) <= flown + MARGIN_M
    }
}

/// Places of each aircraft.
type Tracks = BTreeMap<u32, Vec<Place>>;

/// What one log gives.
struct Run {
    ours: Tracks,
    theirs: Tracks,
    /// Encoded positions with exact parity.
    messages: u32,
    /// Aircraft that two weak frames have borne, with no exact frame of theirs in the whole log.
    never_exact: Vec<u32>,
}

/// Gives every frame that `receive` leaves, as it leaves it, to both trackers.
fn run(frames: &[Heard], mut receive: impl FnMut(&Frame) -> Option<Frame>) -> Run {
    let mut tracker = Box::new(Tracker::<400>::new());
    let mut peer: BTreeMap<ICAO, AircraftState> = BTreeMap::new();
    let mut run = Run {
        ours: Tracks::new(),
        theirs: Tracks::new(),
        messages: 0,
        never_exact: Vec::new(),
    };
    let mut second = 0;
    let (mut exact, mut weakly_born) = (BTreeMap::new(), Vec::new());
    for Heard { at_ms, frame } in frames {
        while second < at_ms / 1000 {
            second += 1;
            tracker.each_second(second * 1000);
        }
        let Some(frame) = receive(frame) else {
            continue;
        };
        let message = Message::decode(&frame);
        let before = tracker.counters().positions_shown;
        let outcome = tracker.on_frame(&frame, &message, tracker::Heard::at(*at_ms));
        let Some(address) = message.address() else {
            continue;
        };
        if matches!(message.parity, mode_s::Parity::Exact(_)) {
            exact.insert(address, ());
        } else if outcome == Outcome::Born {
            weakly_born.push(address);
        }
        let at_s = *at_ms as f64 / 1e3;
        if tracker.counters().positions_shown != before {
            let found = tracker.find(address).and_then(|one| one.position(*at_ms));
            let place = found.expect("a place was shown");
            run.ours.entry(key(address)).or_default().push(Place {
                at_s,
                latitude: degrees(place.latitude),
                longitude: degrees(place.longitude),
            });
        }
        if has_position(&message) {
            run.messages += 1;
            if let Some((latitude, longitude)) = theirs(&mut peer, address, at_s, &frame) {
                run.theirs.entry(key(address)).or_default().push(Place {
                    at_s,
                    latitude,
                    longitude,
                });
            }
        }
    }
    weakly_born.retain(|address| !exact.contains_key(address));
    run.never_exact = weakly_born.into_iter().map(key).collect();
    run
}

fn key(address: Address) -> u32 {
    address.bits() | u32::from(!address.is_icao()) << 24
}

fn has_position(message: &Message) -> bool {
    match message.body {
        Body::ExtendedSquitter { me, .. } => match me {
            Me::AirbornePosition(position) => position.cpr.is_some(),
            Me::SurfacePosition(position) => position.cpr.is_some(),
            _ => false,
        },
        _ => false,
    }
}

/// The place that rs1090's own tracking shows after this frame.
fn theirs(
    peer: &mut BTreeMap<ICAO, AircraftState>,
    address: Address,
    at_s: f64,
    frame: &Frame,
) -> Option<(f64, f64)> {
    let (Address::Icao(Icao(bits)) | Address::NonIcao(bits)) = address;
    let mut me = match peer_rs1090::message(frame)?.df {
        DF::ExtendedSquitterADSB(squitter) => squitter.message,
        DF::ExtendedSquitterTisB { cf, .. } => cf.me,
        _ => return None,
    };
    decode_position(&mut me, at_s, &ICAO(bits), peer, &mut None, &None);
    match me {
        ME::BDS05 { inner, .. } => inner.latitude.zip(inner.longitude),
        ME::BDS06 { inner, .. } => inner.latitude.zip(inner.longitude),
        _ => None,
    }
}

/// Places that most of the places around them contradict.
fn wrong(judged: &Tracks, judges: &[&Tracks]) -> Vec<(u32, Place)> {
    let mut wrong = Vec::new();
    for (&address, places) in judged {
        let mut others: Vec<Place> = judges
            .iter()
            .filter_map(|tracks| tracks.get(&address))
            .flatten()
            .copied()
            .collect();
        others.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        for place in places {
            let from = others.partition_point(|other| other.at_s < place.at_s - AROUND_S);
            let end = others.partition_point(|other| other.at_s <= place.at_s + AROUND_S);
            let around = &others[from..end];
            let against = around.iter().filter(|other| !place.can_be(other)).count();
            if 2 * against > around.len() {
                wrong.push((address, *place));
            }
        }
    }
    wrong
}

/// Places that are farther from the clean run's nearest place in time than the aircraft can have flown.
fn off_track(judged: &Tracks, truth: &Tracks) -> usize {
    let is_off = |track: &[Place], place: &Place| {
        let after = track.partition_point(|other| other.at_s < place.at_s);
        let near = [after.checked_sub(1), Some(after)];
        let near = near.into_iter().flatten().filter_map(|at| track.get(at));
        // Where the clean run shows nothing near in time there is no truth.
        let near: Vec<_> = near
            .filter(|other| (other.at_s - place.at_s).abs() <= AROUND_S)
            .collect();
        !near.is_empty() && near.iter().all(|other| !place.can_be(other))
    };
    judged
        .iter()
        .filter_map(|(address, places)| Some((truth.get(address)?, places)))
        .map(|(track, places)| places.iter().filter(|place| is_off(track, place)).count())
        .sum()
}

fn count(tracks: &Tracks) -> usize {
    tracks.values().map(Vec::len).sum()
}

/// What is wrong with a corrupted message.
#[derive(Clone, Copy)]
enum Fault {
    /// All 34 bits of the encoded position are others.
    AllBits,
    /// One of them is.
    OneBit,
}

/// One in this many position messages is heard.
const HEARD_ONE_IN: u64 = 8;
/// One in this many of those is wrong.
const WRONG_ONE_IN: u64 = 10;

/// Loses most position messages and makes some of the others wrong, with the right parity.
fn badly(fault: Fault) -> impl FnMut(&Frame) -> Option<Frame> {
    // SplitMix64.
    let mut state = 1090u64;
    let mut dice = move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = state;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    };
    move |frame| {
        if !has_position(&Message::decode(frame)) {
            return Some(*frame);
        }
        if dice() % HEARD_ONE_IN != 0 {
            return None;
        }
        if dice() % WRONG_ONE_IN != 0 {
            return Some(*frame);
        }
        let mut bytes: [u8; 14] = frame.bytes().try_into().expect("a long frame");
        let flips = match fault {
            Fault::AllBits => dice(),
            Fault::OneBit => 1 << (dice() % 34),
        } & ((1 << 34) - 1);
        // Bits 55-88 of the frame.
        let flips = flips.to_be_bytes();
        for (byte, flip) in bytes[6..11].iter_mut().zip(&flips[3..]) {
            *byte ^= flip;
        }
        let parity = crc24::remainder(&bytes[..11]).to_be_bytes();
        bytes[11..].copy_from_slice(&parity[1..]);
        Some(Frame::from_bytes(&bytes).expect("still a long frame"))
    }
}

/// Figures of one log: position messages, places shown by us and by rs1090, aircraft with a place by us and by rs1090, rs1090's wrong places.
#[derive(Debug, PartialEq, Eq)]
struct Figures {
    messages: u32,
    ours: usize,
    theirs: usize,
    our_aircraft: usize,
    their_aircraft: usize,
    theirs_wrong: usize,
    /// Places off the track when badly received, wrong messages wrong in all bits, then in one bit: ours, theirs.
    faults: [[usize; 2]; 2],
    /// Aircraft borne by two weak frames that no exact frame ever named.
    never_exact: usize,
}

fn judge(log: Log) -> Figures {
    let frames = log.read();
    let clean = run(&frames, |frame| Some(*frame));
    let ours_wrong = wrong(&clean.ours, &[&clean.ours, &clean.theirs]);
    let theirs_wrong = wrong(&clean.theirs, &[&clean.ours, &clean.theirs]);
    for (address, place) in &ours_wrong {
        println!("wrong: {address:06x} at {:.3} s", place.at_s);
    }
    println!("never exact: {:06x?}", clean.never_exact);
    assert!(
        ours_wrong.is_empty(),
        "{} places are wrong",
        ours_wrong.len()
    );
    let faults = [Fault::AllBits, Fault::OneBit].map(|fault| {
        let run = run(&frames, badly(fault));
        println!(
            "{} and {} places of {} messages",
            count(&run.ours),
            count(&run.theirs),
            run.messages
        );
        [
            off_track(&run.ours, &clean.ours),
            off_track(&run.theirs, &clean.ours),
        ]
    });
    let figures = Figures {
        messages: clean.messages,
        ours: count(&clean.ours),
        theirs: count(&clean.theirs),
        our_aircraft: clean.ours.len(),
        their_aircraft: clean.theirs.len(),
        theirs_wrong: theirs_wrong.len(),
        faults,
        never_exact: clean.never_exact.len(),
    };
    println!("{}: {figures:#?}", log.name());
    figures
}

#[test]
fn no_place_of_the_long_flight_is_wrong() {
    let expected = Figures {
        messages: 12_964,
        ours: 11_789,
        theirs: 11_348,
        our_aircraft: 9,
        their_aircraft: 2,
        theirs_wrong: 0,
        faults: [[0, 0], [0, 2]],
        never_exact: 0,
    };
    assert_eq!(judge(Log::LongFlight), expected);
}

#[test]
fn no_place_of_the_lax_log_is_wrong() {
    let expected = Figures {
        messages: 25_543,
        ours: 24_453,
        theirs: 25_189,
        our_aircraft: 90,
        their_aircraft: 112,
        theirs_wrong: 0,
        faults: [[0, 27], [0, 56]],
        never_exact: 0,
    };
    assert_eq!(judge(Log::Lax), expected);
}
