//! What status messages leave behind, from frames of recorded logs.

use crate::Tracker;
use crate::test_frames::{self, frame, hear};
use mode_s::{Address, Frame, Icao, ModeACode};

/// Airliner 486257 in the air and on the surface, and what it has selected.
const IN_THE_AIR: &str = "8D486257F8230002004BB89498E3";
const ON_THE_SURFACE: &str = "8C486257F9008602884A38A97BC2";

/// A DF17 of airliner 486257 with this ME field.
fn squitter(me: [u8; 7]) -> Frame {
    test_frames::squitter(0x8D, 0x486257, me)
}

/// An airborne position without place: type code, bit 8 and 36 000 ft.
fn position(type_code: u8, bit_8: u8) -> Frame {
    squitter([type_code << 3 | bit_8, 0xB9, 0x80, 0, 0, 0, 0])
}

/// An operational status in the air: version, NIC-A and NACp 8.
fn operational(version: u8, nic_a: u8) -> Frame {
    squitter([0xF8, 0, 0, 0, 0, version << 5 | nic_a << 4 | 8, 0])
}

fn airliner(tracker: &Tracker<4>) -> &crate::Aircraft {
    tracker.find(Address::Icao(Icao(0x486257))).unwrap()
}

#[test]
fn version_is_0_until_told_and_stays() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &position(11, 0), 0);
    assert_eq!(airliner(&tracker).version(), 0);
    assert_eq!(airliner(&tracker).status(0), None);
    hear(&mut tracker, &frame(IN_THE_AIR), 10);
    assert_eq!(airliner(&tracker).version(), 2);
    // Its last status is too old, but the aircraft is still heard.
    hear(&mut tracker, &position(11, 0), 60_000);
    tracker.each_second(60_016);
    assert_eq!(airliner(&tracker).status(60_016), None);
    assert_eq!(airliner(&tracker).version(), 2);
}

#[test]
fn quality_comes_from_both_places_and_the_airframe_stays_in_the_air() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &frame(ON_THE_SURFACE), 0);
    let status = airliner(&tracker).status(0).unwrap();
    assert_eq!((status.nac_p(), status.sil(), status.sda()), (10, 3, 2));
    assert!(status.surface_heading() && !status.magnetic_heading());
    assert_eq!(airliner(&tracker).nacv(0), Some(4));
    hear(&mut tracker, &frame(IN_THE_AIR), 10);
    let aircraft = airliner(&tracker);
    let status = aircraft.status(10).unwrap();
    assert_eq!((status.nac_p(), status.gva()), (11, 2));
    assert!(status.nic_baro() && status.tcas_operational());
    assert_eq!(aircraft.airframe().greatest_m(), Some(45));
    let antenna = aircraft.airframe().antenna().unwrap();
    assert_eq!((antenna.right, antenna.metres), (true, 0));
}

#[test]
fn a_target_state_brings_its_quality_and_tcas() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &frame("8DA05629EA21485CBF3F8CADAEEB"), 0);
    let aircraft = tracker.find(Address::Icao(Icao(0xA05629))).unwrap();
    let status = aircraft.status(0).unwrap();
    assert_eq!((status.nac_p(), status.sil()), (9, 3));
    assert!(status.nic_baro() && status.tcas_operational());
    assert!(!aircraft.tcas_ra(0));
}

#[test]
fn nic_follows_version_and_supplements_whichever_comes_first() {
    let nic = |messages: &[Frame]| {
        let mut tracker = Tracker::<4>::new();
        for message in messages {
            hear(&mut tracker, message, 0);
        }
        airliner(&tracker).nic(0)
    };
    assert_eq!(nic(&[operational(2, 1)]), None);
    assert_eq!(nic(&[position(16, 1)]), Some(1));
    assert_eq!(nic(&[position(16, 1), operational(2, 0)]), Some(2));
    assert_eq!(nic(&[position(16, 1), operational(2, 1)]), Some(3));
    assert_eq!(nic(&[operational(2, 1), position(16, 1)]), Some(3));
    assert_eq!(nic(&[operational(2, 1), position(11, 0)]), Some(8));
    assert_eq!(nic(&[operational(2, 1), position(11, 1)]), Some(9));
    assert_eq!(nic(&[operational(1, 1), position(11, 0)]), Some(9));
}

#[test]
fn bit_8_means_one_antenna_before_version_2_only() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &position(11, 1), 0);
    assert!(airliner(&tracker).single_antenna(0));
    hear(&mut tracker, &position(11, 0), 10);
    assert!(!airliner(&tracker).single_antenna(10));
    hear(&mut tracker, &position(11, 1), 20);
    hear(&mut tracker, &frame(IN_THE_AIR), 30);
    assert!(!airliner(&tracker).single_antenna(30));
}

#[test]
fn an_advisory_lasts_until_it_is_terminated() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &squitter([0xE2, 0x80, 0, 0, 0, 0, 0]), 0);
    assert!(airliner(&tracker).tcas_ra(0));
    hear(
        &mut tracker,
        &squitter([0xE2, 0x80, 0, 1 << 5, 0, 0, 0]),
        800,
    );
    assert!(!airliner(&tracker).tcas_ra(800));
    // Bit 27 of an operational status, and one without.
    hear(
        &mut tracker,
        &squitter([0xF8, 0, 0, 1 << 5, 0, 2 << 5, 0]),
        1_000,
    );
    assert!(airliner(&tracker).tcas_ra(1_000));
    hear(&mut tracker, &frame(IN_THE_AIR), 2_000);
    assert!(!airliner(&tracker).tcas_ra(2_000));
}

#[test]
fn the_ident_switch_and_the_squawk_of_an_emergency_status() {
    let mut tracker = Tracker::<4>::new();
    hear(
        &mut tracker,
        &squitter([0xF9, 0, 0, 1 << 4, 0, 2 << 5, 0]),
        0,
    );
    assert!(airliner(&tracker).ident(0));
    hear(&mut tracker, &frame(ON_THE_SURFACE), 10);
    assert!(!airliner(&tracker).ident(10));
    hear(&mut tracker, &frame("8DA2C1B6E112B600000000760759"), 0);
    let other = tracker.find(Address::Icao(Icao(0xA2C1B6))).unwrap();
    assert_eq!(other.squawk(), Some(ModeACode(0o6513)));
}
