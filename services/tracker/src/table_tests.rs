//! Birth, update and end, and the table against a plain model.

use super::*;
use mode_s::{
    AltitudeFt, Body, Capability, Df, FlightStatus, Frame, Icao, ModeACode, Origin, Parity,
    ReplyControl, crc24,
};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::vec::Vec;

fn message(hex: &str) -> Message {
    let bytes: Vec<u8> = (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect();
    Message::decode(&Frame::from_bytes(&bytes).unwrap())
}

/// DF11, airborne, no interrogator.
fn all_call(icao: u32) -> Message {
    Message {
        df: Df::ALL_CALL_REPLY,
        parity: Parity::Exact(Address::Icao(Icao(icao))),
        body: Body::AllCallReply {
            capability: Capability(5),
        },
    }
}

fn identity(icao: u32, squawk: u16) -> Message {
    Message {
        df: Df::IDENTITY_REPLY,
        parity: Parity::Address(Icao(icao)),
        body: Body::IdentityReply {
            flight_status: FlightStatus(4),
            control: ReplyControl::default(),
            squawk: ModeACode(squawk),
            mb: None,
        },
    }
}

fn icao(bits: u32) -> Address {
    Address::Icao(Icao(bits))
}

fn assert_balanced<const N: usize>(tracker: &Tracker<N>) {
    let c = tracker.counters();
    let frames = c.born + c.updated + c.unknown_address + c.broken + c.not_tracked;
    assert_eq!(c.offered, frames);
    let positions = c.positions_shown + c.positions_waiting + c.positions_refused;
    assert_eq!(c.positions, positions);
    assert_eq!(
        c.born,
        c.timed_out + c.displaced + u32::try_from(tracker.len()).unwrap()
    );
}

#[test]
fn an_aircraft_takes_at_most_240_bytes() {
    let aircraft = size_of::<Aircraft>();
    assert!(aircraft <= 240, "{aircraft}");
    let tracker = size_of::<Tracker<400>>();
    assert!(tracker <= 400 * (aircraft + 4) + 80, "{tracker}");
}

#[test]
fn only_an_exact_parity_bears_an_aircraft() {
    let mut tracker = Tracker::<4>::new();
    let coded = Message {
        parity: Parity::Interrogator {
            icao: Icao(0x4B18FF),
            code: 3,
        },
        ..all_call(0)
    };
    assert_eq!(tracker.on_frame(&coded, 0), Outcome::UnknownAddress);
    assert_eq!(
        tracker.on_frame(&identity(0x4B18FF, 0o1200), 0),
        Outcome::UnknownAddress
    );
    assert!(tracker.is_empty());
    assert_eq!(tracker.on_frame(&all_call(0x4B18FF), 0), Outcome::Born);
    assert_eq!(tracker.on_frame(&coded, 0), Outcome::Updated);
    assert_balanced(&tracker);
}

#[test]
fn address_parity_updates_a_known_aircraft() {
    let mut tracker = Tracker::<4>::new();
    tracker.on_frame(&all_call(0x7C1474), 0);
    assert_eq!(
        tracker.on_frame(&identity(0x7C1474, 0o7700), 100),
        Outcome::Updated
    );
    let aircraft = tracker.find(icao(0x7C1474)).unwrap();
    assert_eq!(aircraft.squawk(), Some(ModeACode(0o7700)));
    assert!(aircraft.ident(100) && aircraft.alert(100));
}

#[test]
fn broken_and_unjudged_frames_change_nothing() {
    let mut tracker = Tracker::<4>::new();
    let broken = message("8D4CA7E858B9838206BA422BBD7A");
    assert_eq!(tracker.on_frame(&broken, 0), Outcome::Broken);
    let military = message("9900000000000000000000000000");
    assert_eq!(tracker.on_frame(&military, 0), Outcome::NotTracked);
    assert!(tracker.is_empty());
    assert_balanced(&tracker);
}

#[test]
fn an_anonymous_address_is_another_aircraft() {
    let mut tracker = Tracker::<4>::new();
    let anonymous = Message {
        parity: Parity::Exact(Address::NonIcao(0x4B18FF)),
        ..all_call(0)
    };
    assert_eq!(tracker.on_frame(&all_call(0x4B18FF), 0), Outcome::Born);
    assert_eq!(tracker.on_frame(&anonymous, 0), Outcome::Born);
    assert_eq!(tracker.len(), 2);
    assert!(tracker.find(Address::NonIcao(0x4B18FF)).is_some());
}

#[test]
fn sixty_seconds_of_silence_end_an_aircraft() {
    let mut tracker = Tracker::<4>::new();
    tracker.on_frame(&all_call(1), 500);
    tracker.on_frame(&all_call(2), 2_000);
    tracker.each_second(60_500);
    assert_eq!(tracker.len(), 2);
    tracker.each_second(61_000);
    assert!(tracker.find(icao(1)).is_none());
    assert!(tracker.find(icao(2)).is_some());
    assert_eq!(tracker.counters().timed_out, 1);
    assert_balanced(&tracker);
}

#[test]
fn a_frame_stamped_after_the_second_keeps_its_aircraft() {
    let mut tracker = Tracker::<4>::new();
    tracker.on_frame(&all_call(1), 1_003);
    tracker.each_second(1_000);
    assert_eq!(tracker.len(), 1);
}

#[test]
fn the_longest_silent_makes_place() {
    let mut tracker = Tracker::<3>::new();
    for (address, at) in [(1, 0), (2, 10), (3, 20), (1, 30)] {
        tracker.on_frame(&all_call(address), at);
    }
    assert_eq!(tracker.on_frame(&all_call(4), 40), Outcome::Born);
    assert!(tracker.find(icao(2)).is_none());
    for address in [1, 3, 4] {
        assert!(tracker.find(icao(address)).is_some(), "{address}");
    }
    assert_eq!(tracker.counters().displaced, 1);
    assert_balanced(&tracker);
}

#[test]
fn frames_of_a_second_are_counted() {
    let mut tracker = Tracker::<3>::new();
    for at in [0, 100, 200] {
        tracker.on_frame(&all_call(1), at);
    }
    let frames = |tracker: &Tracker<3>| tracker.find(icao(1)).unwrap().frames_last_second();
    assert_eq!(frames(&tracker), 0);
    tracker.each_second(1_000);
    assert_eq!(frames(&tracker), 3);
    tracker.each_second(2_000);
    assert_eq!(frames(&tracker), 0);
}

#[test]
fn gnss_height_is_pressure_altitude_and_difference() {
    // Altitude 36 000 ft, then the published velocity with +550 ft, both of one aircraft.
    let mut tracker = Tracker::<3>::new();
    let Body::ExtendedSquitter { me, .. } = message("8D4CA7E858B9838206BA422BBD7B").body else {
        panic!()
    };
    let position = Message {
        body: Body::ExtendedSquitter {
            origin: Origin::Device,
            me,
        },
        ..message("8D485020994409940838175B284F")
    };
    tracker.on_frame(&position, 0);
    tracker.on_frame(&message("8D485020994409940838175B284F"), 500);
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert_eq!(aircraft.baro_altitude(500), Some(AltitudeFt(36_000)));
    assert_eq!(aircraft.gnss_altitude(500), Some(AltitudeFt(36_550)));
    assert_eq!(aircraft.gnss_altitude(60_501), None);
}

#[test]
fn what_is_older_than_a_minute_is_not_told() {
    let mut tracker = Tracker::<3>::new();
    tracker.on_frame(&message("8D485020994409940838175B284F"), 0);
    for second in 1..=61 {
        tracker.on_frame(&all_call(0x485020), second * 1_000);
        tracker.each_second(second * 1_000);
    }
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert_eq!(aircraft.ground_speed_eighths(61_000), None);
    assert_eq!(aircraft.vertical_rate(61_000), None);
}

/// The published pairs: airborne near Hawaii, and on the surface at Schiphol.
const HAWAII: [&str; 2] = [
    "8da6147f5859f18cdf4d244ac6fa",
    "8da6147f585b05533e2ba73e43cb",
];
const SCHIPHOL: [&str; 2] = [
    "8C4841753AAB238733C8CD4020B1",
    "8C4841753A8A35323FAEBDAC702D",
];

#[test]
fn surface_speed_track_and_ground() {
    let mut tracker = Tracker::<3>::new();
    tracker.on_frame(&message(SCHIPHOL[0]), 0);
    let aircraft = tracker.find(icao(0x484175)).unwrap();
    assert_eq!(aircraft.on_ground(), Some(true));
    assert_eq!(aircraft.ground_speed_eighths(0), Some(18 * 8));
    assert!(aircraft.track(0).is_some());
    tracker.on_frame(&message("8D485020994409940838175B284F"), 0);
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert_eq!(aircraft.on_ground(), Some(false));
    assert_eq!(aircraft.ground_speed_eighths(0), Some(159 * 8));
}

#[test]
fn surveillance_status_of_a_position_sets_ident_or_alert() {
    let mut tracker = Tracker::<3>::new();
    for (status, ident, alert) in [
        (0, false, false),
        (1, false, true),
        (2, false, true),
        (3, true, false),
    ] {
        let mut bytes = [0; 14];
        bytes[..5].copy_from_slice(&[0x8D, 0, 0, 1, 11 << 3 | status << 1]);
        let parity = crc24::remainder(&bytes[..11]).to_be_bytes();
        bytes[11..].copy_from_slice(&parity[1..]);
        let frame = Frame::from_bytes(&bytes).unwrap();
        tracker.on_frame(&Message::decode(&frame), 0);
        let aircraft = tracker.find(icao(1)).unwrap();
        assert_eq!(
            (aircraft.ident(0), aircraft.alert(0)),
            (ident, alert),
            "SS {status}"
        );
    }
}

#[test]
fn an_aircraft_in_the_air_is_the_reference_for_those_on_the_surface() {
    let surface = |tracker: &mut Tracker<3>| {
        for at in 0..4 {
            tracker.on_frame(&message(SCHIPHOL[at % 2]), 2_000 + 100 * at as u64);
        }
        tracker.find(icao(0x484175)).unwrap().position(2_400)
    };
    assert_eq!(surface(&mut Tracker::new()), None);

    let mut tracker = Tracker::new();
    for at in 0..4 {
        tracker.on_frame(&message(HAWAII[at % 2]), 100 * at as u64);
    }
    // The pair is decoded near Hawaii: a wrong quarter, but a quarter of this reference.
    let place = surface(&mut tracker).unwrap();
    assert!((place.latitude - 523_206_070).abs() < 100, "{place:?}");
    let quarter = (place.longitude - 47_347_350).rem_euclid(900_000_000);
    assert!(!(100..899_999_900).contains(&quarter), "{place:?}");
    assert!((place.longitude + 1_565_328_500).abs() < 450_000_000);
}

#[test]
fn the_receivers_place_is_a_reference_and_a_limit() {
    let amsterdam = Position {
        latitude: 519_900_000,
        longitude: 43_750_000,
    };
    let mut tracker = Tracker::<3>::new();
    tracker.set_receiver(Some(amsterdam));
    for at in 0..4 {
        tracker.on_frame(&message(SCHIPHOL[at % 2]), 100 * at as u64);
        tracker.on_frame(&message(HAWAII[at % 2]), 100 * at as u64);
    }
    let place = |address| tracker.find(icao(address)).unwrap().position(400);
    let schiphol = place(0x484175).unwrap();
    assert!((schiphol.longitude - 47_347_350).abs() < 100);
    assert_eq!(place(0xA6147F), None);
    assert_balanced(&tracker);
}

#[test]
fn airspeed_and_heading_are_no_ground_speed_and_track() {
    let mut tracker = Tracker::<3>::new();
    tracker.on_frame(&message("8DA05F219B06B6AF189400CBC33F"), 0);
    let aircraft = tracker.find(icao(0xA05F21)).unwrap();
    assert_eq!(aircraft.heading(0).map(|heading| heading.0), Some(24_398));
    assert_eq!(aircraft.airspeed(0).map(|speed| speed.knots), Some(375));
    assert_eq!(aircraft.track(0), None);
    assert_eq!(aircraft.ground_speed_eighths(0), None);
    assert_eq!(aircraft.nacv(0), Some(0));
}

#[test]
fn an_old_difference_gives_no_gnss_height() {
    let altitude = |at_ms| {
        let reply = Message {
            df: Df::ALTITUDE_REPLY,
            parity: Parity::Address(Icao(0x485020)),
            body: Body::AltitudeReply {
                flight_status: FlightStatus(0),
                control: ReplyControl::default(),
                altitude: Some(AltitudeFt(1_000)),
                metres: None,
                mb: None,
            },
        };
        let mut tracker = Tracker::<3>::new();
        tracker.on_frame(&message("8D485020994409940838175B284F"), 1_000);
        tracker.on_frame(&reply, at_ms);
        let aircraft = tracker.find(icao(0x485020)).unwrap();
        aircraft.gnss_altitude(at_ms)
    };
    assert_eq!(altitude(11_000), Some(AltitudeFt(1_550)));
    assert_eq!(altitude(11_001), None);
}

/// One step of the model test.
#[derive(Clone, Copy, Debug)]
enum Step {
    Heard(u32),
    Seconds(u64),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        20 => (0..40u32).prop_map(|n| Step::Heard(n * 0x10001)),
        1 => (1..40u64).prop_map(Step::Seconds),
    ];
    prop::collection::vec(step, 0..400)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Sixteen places, forty addresses: births, displacement and time-outs in any order.
    #[test]
    fn the_table_agrees_with_a_plain_map(steps in steps()) {
        let mut tracker = Tracker::<16>::new();
        let mut model: BTreeMap<u32, u64> = BTreeMap::new();
        let mut now = 0;
        for step in steps {
            now += 1;
            match step {
                Step::Heard(address) => {
                    tracker.on_frame(&all_call(address), now);
                    if !model.contains_key(&address) && model.len() == 16 {
                        let (&oldest, _) = model.iter().min_by_key(|(_, heard)| **heard).unwrap();
                        model.remove(&oldest);
                    }
                    model.insert(address, now);
                }
                Step::Seconds(seconds) => {
                    now += seconds * 1_000;
                    tracker.each_second(now);
                    model.retain(|_, heard| now - *heard <= u64::from(TIMEOUT_MS));
                }
            }
            let mut listed: Vec<u32> = tracker.aircraft().map(|a| a.address().bits()).collect();
            listed.sort_unstable();
            prop_assert_eq!(&listed, &model.keys().copied().collect::<Vec<_>>());
            for &address in model.keys() {
                prop_assert!(tracker.find(icao(address)).is_some());
            }
        }
        assert_balanced(&tracker);
    }

    #[test]
    fn any_frames_leave_balanced_sums(frames in prop::collection::vec((any::<[u8; 14]>(), 0..4u8, 0..3_000u64), 0..200)) {
        let mut tracker = Tracker::<4>::new();
        let mut now = 0;
        for (mut bytes, address, later) in frames {
            now += later;
            // Mostly extended squitters of four aircraft, with a right parity.
            if address != 0 {
                bytes[0] = 0x8D;
                bytes[1..4].copy_from_slice(&[0, 0, address]);
                let parity = crc24::remainder(&bytes[..11]).to_be_bytes();
                bytes[11..].copy_from_slice(&parity[1..]);
            }
            let length = if Df::of_first_byte(bytes[0]).is_long() { 14 } else { 7 };
            let frame = Frame::from_bytes(&bytes[..length]).unwrap();
            tracker.on_frame(&Message::decode(&frame), now);
            if now % 3 == 0 {
                tracker.each_second(now);
            }
        }
        assert_balanced(&tracker);
    }
}
