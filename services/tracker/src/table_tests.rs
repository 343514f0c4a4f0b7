//! Birth, update and end, and the table against a plain model.

use super::*;
use crate::test_frames::*;
use mode_s::{Df, crc24};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::vec::Vec;

fn icao(bits: u32) -> Address {
    Address::Icao(Icao(bits))
}

fn assert_balanced<const N: usize>(tracker: &Tracker<N>) {
    let c = tracker.counters();
    let tracked = c.born + c.updated;
    let not = c.duplicate + c.unknown_address + c.no_address + c.no_place;
    assert_eq!(c.offered, tracked + not + c.broken + c.not_tracked);
    let positions = c.positions_shown + c.positions_waiting + c.positions_refused;
    assert_eq!(c.positions, positions);
    let ended = c.timed_out + c.displaced;
    assert_eq!(c.born, ended + u32::try_from(tracker.len()).unwrap());
}

#[test]
fn an_exact_parity_bears_an_aircraft_and_any_updates_it() {
    let mut tracker = Tracker::<4>::new();
    assert_eq!(hear(&mut tracker, &all_call(0x4B18FF), 0), Outcome::Born);
    assert!(tracker.find(icao(0x4B18FF)).unwrap().is_confirmed());
    for (at_ms, frame) in [
        (10, coded_all_call(0x4B18FF, 3)),
        (20, identity(0x4B18FF, 0)),
        (30, altitude(0x4B18FF, 5_000)),
    ] {
        assert_eq!(hear(&mut tracker, &frame, at_ms), Outcome::Updated);
    }
    assert_eq!(tracker.len(), 1);
    assert_balanced(&tracker);
}

#[test]
fn two_weak_frames_that_agree_bear_an_aircraft() {
    for (first, second, outcome) in [
        (
            coded_all_call(0x4B18FF, 3),
            altitude(0x4B18FF, 5_000),
            Outcome::Born,
        ),
        (
            altitude(0x4B18FF, 5_000),
            altitude(0x4B18FF, 5_050),
            Outcome::Born,
        ),
        (
            identity(0x4B18FF, 0x808),
            identity(0x4B18FF, 0x808),
            Outcome::Born,
        ),
        (
            altitude(0x4B18FF, 5_000),
            altitude(0x4B18FF, 9_000),
            Outcome::UnknownAddress,
        ),
        (
            altitude(0x4B18FF, 5_000),
            identity(0x4B18FF, 0x808),
            Outcome::UnknownAddress,
        ),
        (
            altitude(0x4B18FF, 5_000),
            altitude(0x4B18FE, 5_000),
            Outcome::UnknownAddress,
        ),
    ] {
        let mut tracker = Tracker::<4>::new();
        assert_eq!(hear(&mut tracker, &first, 0), Outcome::UnknownAddress);
        assert_eq!(
            hear(&mut tracker, &second, 500),
            outcome,
            "{first:?} {second:?}"
        );
        if let Some(aircraft) = tracker.find(icao(0x4B18FF)) {
            assert!(!aircraft.is_confirmed());
        }
        assert_balanced(&tracker);
    }
}

#[test]
fn the_same_transmission_twice_does_not_agree_with_itself() {
    let mut tracker = Tracker::<4>::new();
    let weak = altitude(0x4B18FF, 5_000);
    assert_eq!(hear(&mut tracker, &weak, 100), Outcome::UnknownAddress);
    assert_eq!(hear(&mut tracker, &weak, 101), Outcome::Duplicate);
    assert!(tracker.is_empty());
}

#[test]
fn a_repaired_frame_bears_no_aircraft_alone() {
    let mut tracker = Tracker::<4>::new();
    let frame = frame(VELOCITY);
    let message = Message::decode(&frame);
    let repaired = |at_ms| Heard {
        is_repaired: true,
        ..Heard::at(at_ms)
    };
    let outcome = tracker.on_frame(&frame, &message, repaired(0));
    assert_eq!(outcome, Outcome::UnknownAddress);
    assert_eq!(
        tracker.on_frame(&frame, &message, repaired(500)),
        Outcome::Born
    );
    assert!(!tracker.find(icao(0x485020)).unwrap().is_confirmed());
    assert_balanced(&tracker);
}

#[test]
fn a_ghost_of_one_wrong_bit_is_not_born() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &all_call(0x4B18FF), 0);
    // The same bit of two altitude replies is wrong: bit 9 (DR), which says nothing.
    for at_ms in [100, 600, 1_100] {
        let mut bytes = Vec::from(altitude(0x4B18FF, 5_000).bytes());
        bytes[1] ^= 0x80;
        let ghost = Frame::from_bytes(&bytes).unwrap();
        assert_eq!(hear(&mut tracker, &ghost, at_ms), Outcome::UnknownAddress);
    }
    assert_eq!(tracker.len(), 1);
}

#[test]
fn nobody_has_the_address_of_all_zeros_or_ones() {
    let mut tracker = Tracker::<4>::new();
    for address in [0, 0xFF_FFFF] {
        for at_ms in [0, 500, 1_000] {
            for frame in [
                all_call(address),
                altitude(address, 5_000),
                squitter(0x8D, address, [0x58, 0, 0, 0, 0, 0, 0]),
                squitter(0x91, address, [0x58, 0, 0, 0, 0, 0, 0]),
            ] {
                assert_eq!(hear(&mut tracker, &frame, at_ms), Outcome::NoAddress);
            }
        }
    }
    // All bits zero: DF0, whose parity hides the address 0.
    let zeros = Frame::from_bytes(&[0; 7]).unwrap();
    assert_eq!(hear(&mut tracker, &zeros, 2_000), Outcome::NoAddress);
    assert_balanced(&tracker);
}

#[test]
fn broken_and_unjudged_frames_change_nothing() {
    let mut tracker = Tracker::<4>::new();
    let broken = frame("8D4CA7E858B9838206BA422BBD7A");
    assert_eq!(hear(&mut tracker, &broken, 0), Outcome::Broken);
    let military = frame("9900000000000000000000000000");
    assert_eq!(hear(&mut tracker, &military, 0), Outcome::NotTracked);
    assert!(tracker.is_empty());
    assert_balanced(&tracker);
}

#[test]
fn an_anonymous_address_is_another_aircraft() {
    let mut tracker = Tracker::<4>::new();
    // CF 1: an anonymous address; then the aircraft that owns the number.
    let anonymous = squitter(0x91, 0x4B18FF, [0x58, 0xB9, 0x80, 0, 0, 0, 0]);
    assert_eq!(hear(&mut tracker, &anonymous, 0), Outcome::Born);
    assert_eq!(hear(&mut tracker, &all_call(0x4B18FF), 0), Outcome::Born);
    assert_eq!(
        hear(&mut tracker, &altitude(0x4B18FF, 1_000), 0),
        Outcome::Updated
    );
    assert_eq!(tracker.len(), 2);
    let of = |address| tracker.find(address).unwrap().baro_altitude(0).unwrap().0;
    assert_eq!(of(Address::NonIcao(0x4B18FF)), 36_000);
    assert_eq!(of(icao(0x4B18FF)), 1_000);
}

#[test]
fn sixty_seconds_of_silence_end_an_aircraft() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &all_call(1), 500);
    hear(&mut tracker, &all_call(2), 2_000);
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
    hear(&mut tracker, &all_call(1), 1_003);
    tracker.each_second(1_000);
    assert_eq!(tracker.len(), 1);
}

#[test]
fn silence_ends_an_aircraft_when_nobody_ends_a_second() {
    // 262 144 ms are a round of the stamps: no gap may bring an aircraft back.
    for gap in [65_004, 262_144, 262_148, 524_288, 1 << 32, 1 << 40] {
        let mut tracker = Tracker::<4>::new();
        hear(&mut tracker, &frame(VELOCITY), 1_000);
        hear(&mut tracker, &all_call(2), 1_000 + gap);
        assert!(tracker.find(icao(0x485020)).is_none(), "{gap}");
        hear(&mut tracker, &all_call(0x485020), 1_100 + gap);
        let again = tracker.find(icao(0x485020)).unwrap();
        assert_eq!(again.ground_speed_eighths(1_100 + gap), None);
        assert_balanced(&tracker);
    }
}

#[test]
fn a_clock_that_goes_back_begins_anew() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &all_call(1), 1_000_000);
    hear(&mut tracker, &all_call(2), 1_000);
    assert!(tracker.find(icao(1)).is_none());
    tracker.each_second(2_000);
    assert_eq!(tracker.len(), 1);
    assert_balanced(&tracker);
}

#[test]
fn worth_decides_who_leaves() {
    let weak = |tracker: &mut Tracker<3>, address, at_ms| {
        hear(tracker, &coded_all_call(address, 1), at_ms);
        hear(tracker, &coded_all_call(address, 2), at_ms)
    };
    let mut tracker = Tracker::<3>::new();
    for (at, hex) in (0..4).map(|at| (at, HAWAII[at % 2])) {
        hear(&mut tracker, &frame(hex), 400 * at as u64);
    }
    assert!(
        tracker
            .find(icao(0xA6147F))
            .unwrap()
            .position(1_200)
            .is_some()
    );
    hear(&mut tracker, &frame(VELOCITY), 1_200);
    hear(&mut tracker, &all_call(3), 1_200);
    // As fresh as those it meets, a weak one is worth less, and one like another is not worth more.
    assert_eq!(weak(&mut tracker, 4, 1_200), Outcome::NoPlace);
    assert_eq!(hear(&mut tracker, &all_call(5), 1_200), Outcome::NoPlace);
    // Squitters are worth more than an all-call reply, and then as much as squitters.
    let squitters = squitter(0x8D, 6, [0x58, 0xB9, 0x80, 0, 0, 0, 0]);
    assert_eq!(hear(&mut tracker, &squitters, 1_200), Outcome::Born);
    assert!(tracker.find(icao(3)).is_none());
    // After 8 s of silence they are worth less than an all-call reply just heard; the position is not.
    assert_eq!(hear(&mut tracker, &all_call(7), 9_200), Outcome::NoPlace);
    assert_eq!(hear(&mut tracker, &all_call(7), 9_204), Outcome::Born);
    assert!(tracker.find(icao(0x485020)).is_none());
    assert_eq!(hear(&mut tracker, &all_call(8), 9_208), Outcome::Born);
    assert_eq!(hear(&mut tracker, &all_call(9), 9_208), Outcome::NoPlace);
    assert!(tracker.find(icao(0xA6147F)).is_some());
    // After 18 s it is.
    for address in [7, 8] {
        hear(&mut tracker, &all_call(address), 19_200);
    }
    assert_eq!(hear(&mut tracker, &all_call(10), 19_204), Outcome::Born);
    assert!(tracker.find(icao(0xA6147F)).is_none());
    assert_eq!(tracker.counters().displaced, 4);
    assert_balanced(&tracker);
}

#[test]
fn four_hundred_aircraft_at_the_channels_rate_keep_their_places() {
    let mut tracker = std::boxed::Box::new(Tracker::<400>::new());
    let address = |n: u32| n.wrapping_mul(2_654_435_761) >> 8 | 1;
    // 8 333 frames a second for 20 s, from 450 aircraft in turn.
    let mut shown = 0;
    for n in 0..166_660u32 {
        let at_ms = u64::from(n) * 120 / 1_000;
        if n % 8_333 == 0 {
            tracker.each_second(at_ms);
            shown = tracker.len();
        }
        hear(&mut tracker, &all_call(address(n % 450)), at_ms);
    }
    assert_eq!(shown, 400);
    let c = tracker.counters();
    // All-call replies come again after 54 ms: nobody has been silent for long enough to leave.
    assert_eq!((c.born, c.displaced), (400, 0));
    assert_eq!(c.no_place, c.offered - c.born - c.updated);
    assert!(
        tracker
            .aircraft()
            .all(|one| one.counts_last_second().mode_s >= 18)
    );
    assert_balanced(&tracker);
}

#[test]
fn a_turn_in_slices_ends_each_second_once_whoever_leaves_meanwhile() {
    // Slices of one, places for four, and frames of newcomers between the slices that displace the silent ones: those that are heard once a second
    // must tell one frame after every turn.
    for slice in 1..4 {
        let mut tracker = Tracker::<4>::new();
        // They stand first, so that those who stay are at the end and move.
        hear(&mut tracker, &all_call(0x50), 0);
        hear(&mut tracker, &all_call(0x51), 0);
        let mut newcomer = 0x100;
        for second in 1..60u64 {
            let now_ms = second * 4_000;
            for steady in [1, 2] {
                hear(&mut tracker, &all_call(steady), now_ms - 500);
            }
            tracker.begin_second(now_ms);
            let mut later_ms = now_ms;
            while tracker.go_on(slice) {
                later_ms += 8;
                newcomer += 1;
                hear(&mut tracker, &all_call(newcomer), later_ms);
            }
            for steady in [1, 2] {
                let aircraft = tracker.find(icao(steady)).unwrap();
                assert_eq!(aircraft.counts_last_second().mode_s, 1, "{second} {slice}");
            }
            assert!(
                tracker
                    .aircraft()
                    .all(|one| one.flags.has(Flag::Turn) == tracker.turn)
            );
        }
        assert!(tracker.counters().displaced > 50);
        assert_balanced(&tracker);
    }
}

/// One step of the model test.
#[derive(Clone, Copy, Debug)]
enum Step {
    Heard(u32),
    Seconds(u64),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        20 => (1..=40u32).prop_map(|n| Step::Heard(n * 0x10001)),
        3 => (1..40u64).prop_map(Step::Seconds),
    ];
    prop::collection::vec(step, 0..400)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Sixteen places, forty addresses of equal worth but for their silence: births, displacement and time-outs in any order.
    #[test]
    fn the_table_agrees_with_a_plain_map(steps in steps()) {
        let mut tracker = Tracker::<16>::new();
        let mut model: BTreeMap<u32, u64> = BTreeMap::new();
        let mut now = 0;
        for step in steps {
            // Two units of a stamp.
            now += 8;
            match step {
                Step::Heard(address) => {
                    hear(&mut tracker, &all_call(address), now);
                    if !model.contains_key(&address) && model.len() == 16 {
                        let (&oldest, &heard) = model.iter().min_by_key(|(_, heard)| **heard).unwrap();
                        if now - heard <= 3_000 {
                            continue;
                        }
                        model.remove(&oldest);
                    }
                    model.insert(address, now);
                }
                Step::Seconds(seconds) => {
                    now += seconds * 1_000;
                    tracker.begin_second(now);
                    while tracker.go_on(3) {}
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
            hear(&mut tracker, &frame, now);
            if now % 3 == 0 {
                tracker.each_second(now);
            }
        }
        assert_balanced(&tracker);
    }
}
