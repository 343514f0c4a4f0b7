//! What frames leave behind in the aircraft that sent them.

use crate::test_frames::{self, *};
use crate::{Field, Heard, Outcome, PositionSource, RxPosition, Tracker};
use mode_s::{Address, AltitudeFt, CprFormat, EmergencyState, Icao, Message, ModeACode, Position};

fn icao(bits: u32) -> Address {
    Address::Icao(Icao(bits))
}

#[test]
fn identity_reply_sets_squawk_ident_and_alert() {
    let mut tracker = Tracker::<4>::new();
    hear(&mut tracker, &all_call(0x7C1474), 0);
    // A4 A2 A1, B4 B2 B1 and nothing else: 7700.
    let reply = identity(0x7C1474, 0o5252);
    assert_eq!(hear(&mut tracker, &reply, 100), Outcome::Updated);
    let aircraft = tracker.find(icao(0x7C1474)).unwrap();
    assert_eq!(aircraft.squawk(), Message::decode(&reply).squawk());
    assert!(aircraft.ident(100) && aircraft.alert(100));
}

/// The Mode A code of a reply.
trait Squawk {
    fn squawk(&self) -> Option<ModeACode>;
}

impl Squawk for Message {
    fn squawk(&self) -> Option<ModeACode> {
        match self.body {
            mode_s::Body::IdentityReply { squawk, .. } => Some(squawk),
            _ => None,
        }
    }
}

#[test]
fn messages_of_a_second_are_counted_by_kind() {
    let mut tracker = Tracker::<3>::new();
    for at in [0, 100, 200] {
        hear(&mut tracker, &all_call(0x485020), at);
    }
    hear(&mut tracker, &frame(VELOCITY), 300);
    hear(&mut tracker, &frame(VELOCITY), 301);
    hear(&mut tracker, &identity(0x485020, 0), 400);
    tracker.on_mode_ac(ModeACode(0));
    let counts = |tracker: &Tracker<3>| {
        let counts = tracker.find(icao(0x485020)).unwrap().counts_last_second();
        (counts.mode_s, counts.mode_ac)
    };
    assert_eq!(counts(&tracker), (0, 0));
    tracker.each_second(1_000);
    assert_eq!(counts(&tracker), (5, 1));
    tracker.each_second(2_000);
    assert_eq!(counts(&tracker), (0, 0));
}

#[test]
fn level_and_quality_are_the_means_of_a_second() {
    let mut tracker = Tracker::<3>::new();
    let frame = all_call(0x485020);
    for (at_ms, level) in [(0, -7_000), (100, -6_000)] {
        let heard = Heard {
            level_cdbm: Some(level),
            quality_cdb: Some(level + 9_000),
            ..Heard::at(at_ms)
        };
        tracker.on_frame(&frame, &Message::decode(&frame), heard);
    }
    tracker.each_second(1_000);
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert_eq!(aircraft.level_cdbm(), Some(-6_500));
    assert_eq!(aircraft.quality_cdb(), Some(2_500));
}

#[test]
fn updates_are_told_for_one_second() {
    let mut tracker = Tracker::<3>::new();
    hear(&mut tracker, &frame(VELOCITY), 0);
    tracker.each_second(1_000);
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    let updated = |field| aircraft.updated_last_second().has(field);
    assert!(updated(Field::GroundSpeed) && updated(Field::Track) && updated(Field::VerticalRate));
    assert!(!updated(Field::BaroAltitude) && !updated(Field::Position));
    assert_eq!(aircraft.age_ms(Field::Track, 1_000), Some(996));
    tracker.each_second(2_000);
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert!(!aircraft.updated_last_second().has(Field::Track));
}

#[test]
fn gnss_height_is_pressure_altitude_and_difference() {
    let mut tracker = Tracker::<3>::new();
    // A position without a place, at 36 000 ft.
    let position = squitter(0x8D, 0x485020, [0x58, 0xB9, 0x80, 0, 0, 0, 0]);
    hear(&mut tracker, &position, 4);
    hear(&mut tracker, &frame(VELOCITY), 500);
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert_eq!(aircraft.baro_altitude(500), Some(AltitudeFt(36_000)));
    assert_eq!(aircraft.gnss_altitude(500), Some(AltitudeFt(36_550)));
    assert_eq!(aircraft.gnss_altitude(60_504), None);
}

#[test]
fn an_old_difference_gives_no_gnss_height() {
    let height = |at_ms| {
        let mut tracker = Tracker::<3>::new();
        hear(&mut tracker, &frame(VELOCITY), 1_000);
        hear(&mut tracker, &altitude(0x485020, 1_000), at_ms);
        let aircraft = tracker.find(icao(0x485020)).unwrap();
        aircraft.gnss_altitude(at_ms)
    };
    assert_eq!(height(11_000), Some(AltitudeFt(1_550)));
    assert_eq!(height(11_004), None);
}

#[test]
fn what_is_older_than_a_minute_is_not_told() {
    let mut tracker = Tracker::<3>::new();
    hear(&mut tracker, &frame(VELOCITY), 0);
    for second in 1..=61 {
        hear(&mut tracker, &all_call(0x485020), second * 1_000);
        tracker.each_second(second * 1_000);
    }
    let aircraft = tracker.find(icao(0x485020)).unwrap();
    assert_eq!(aircraft.ground_speed_eighths(61_000), None);
    assert_eq!(aircraft.vertical_rate(61_000), None);
}

#[test]
fn surface_speed_track_and_ground() {
    let mut tracker = Tracker::<3>::new();
    hear(&mut tracker, &frame("8C4841753AAB238733C8CD4020B1"), 0);
    let aircraft = tracker.find(Address::Icao(TAXIING)).unwrap();
    assert_eq!(aircraft.on_ground(), Some(true));
    assert_eq!(aircraft.ground_speed_eighths(0), Some(18 * 8));
    assert!(aircraft.track(0).is_some());
    hear(&mut tracker, &frame(VELOCITY), 0);
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
        let position = squitter(0x8D, 1, [11 << 3 | status << 1, 0, 0, 0, 0, 0, 0]);
        hear(&mut tracker, &position, 0);
        let aircraft = tracker.find(icao(1)).unwrap();
        assert_eq!(
            (aircraft.ident(0), aircraft.alert(0)),
            (ident, alert),
            "SS {status}"
        );
    }
}

#[test]
fn target_state_tells_what_is_selected() {
    let mut tracker = Tracker::<3>::new();
    // Published: selected altitude 16 992 ft by MCP, 1012.8 hPa, heading 66.8°.
    hear(&mut tracker, &frame("8DA05629EA21485CBF3F8CADAEEB"), 0);
    let aircraft = tracker.find(icao(0xA05629)).unwrap();
    assert_eq!(aircraft.selected_altitude_mcp(0), Some(AltitudeFt(16_992)));
    assert_eq!(aircraft.selected_altitude_fms(0), None);
    assert_eq!(aircraft.pressure_setting_tenths(0), Some(10_128));
    assert_eq!(
        aircraft.selected_heading(0).map(|h| h.whole_degrees()),
        Some(67)
    );
    let modes = aircraft.modes(0).unwrap();
    assert!(modes.autopilot && modes.vnav && modes.lnav && !modes.approach);
}

#[test]
fn emergency_state_and_military() {
    let mut tracker = Tracker::<3>::new();
    hear(&mut tracker, &frame("8DA2C1B6E112B600000000760759"), 0);
    let aircraft = tracker.find(icao(0xA2C1B6)).unwrap();
    assert_eq!(aircraft.emergency(0), Some(EmergencyState::None));
    assert!(!aircraft.is_military());
}

/// Hears the pair near Hawaii twice over, 500 ms apart.
fn hear_hawaii(tracker: &mut Tracker<3>, from_ms: u64) {
    for at in 0..4 {
        hear(tracker, &frame(HAWAII[at % 2]), from_ms + 500 * at as u64);
    }
}

/// The aircraft that [`hear_schiphol`] hears.
const TAXIING: Icao = Icao(0x484175);

/// Hears an aircraft stand at Schiphol, two pairs 500 ms apart.
fn hear_schiphol(tracker: &mut Tracker<3>, from_ms: u64) -> Option<Position> {
    let formats = [CprFormat::Even, CprFormat::Odd];
    for at in 0..4 {
        let position = on_surface(TAXIING.0, formats[at % 2], test_frames::at(52.32, 4.73));
        hear(tracker, &position, from_ms + 500 * at as u64);
    }
    tracker
        .find(Address::Icao(TAXIING))
        .unwrap()
        .position(from_ms + 1_500)
}

#[test]
fn an_aircraft_in_the_air_is_the_reference_for_those_on_the_surface() {
    assert_eq!(hear_schiphol(&mut Tracker::new(), 2_000), None);

    let mut tracker = Tracker::new();
    hear_hawaii(&mut tracker, 0);
    // The pair is decoded near Hawaii: a wrong quarter, but a quarter of this reference.
    let place = hear_schiphol(&mut tracker, 2_000).unwrap();
    assert!((place.latitude - 523_200_000).abs() < 100, "{place:?}");
    let quarter = (place.longitude - 47_300_000).rem_euclid(900_000_000);
    assert!(!(200..899_999_800).contains(&quarter), "{place:?}");
    assert!((place.longitude + 1_565_328_500).abs() < 450_000_000);
}

const AMSTERDAM: Position = Position {
    latitude: 519_900_000,
    longitude: 43_750_000,
};

#[test]
fn the_receivers_place_is_a_reference_and_a_limit() {
    for (rx, is_known) in [
        (RxPosition::None, false),
        (RxPosition::Gnss(None), false),
        (RxPosition::Gnss(Some(AMSTERDAM)), true),
        (RxPosition::Fixed(AMSTERDAM), true),
    ] {
        let mut tracker = Tracker::<3>::new();
        tracker.set_rx_position(rx);
        let schiphol = hear_schiphol(&mut tracker, 0);
        hear_hawaii(&mut tracker, 2_000);
        let hawaii = tracker.find(icao(0xA6147F)).unwrap().position(3_500);
        // Unknown, nothing lies near Schiphol; known, Hawaii is out of its range.
        let longitude = schiphol.map(|place| (place.longitude + 500) / 1_000);
        assert_eq!(longitude, is_known.then_some(47_300), "{rx:?}");
        assert_eq!(hawaii.is_some(), !is_known, "{rx:?}");
    }
}

#[test]
fn lowest_and_named_aircraft_stand_for_the_receiver() {
    for (rx, is_reference) in [
        (RxPosition::Lowest, true),
        (RxPosition::Icao(Icao(0xA6147F)), true),
        (RxPosition::Icao(Icao(0xA6147E)), false),
    ] {
        let mut tracker = Tracker::<3>::new();
        tracker.set_rx_position(rx);
        hear_hawaii(&mut tracker, 0);
        tracker.each_second(2_000);
        assert_eq!(tracker.references().named.is_some(), is_reference, "{rx:?}");
        // Aboard that aircraft Schiphol's quarter near it is still out of range; of the lowest one nobody knows how far it is.
        let place = hear_schiphol(&mut tracker, 2_000);
        let is_aboard = matches!(rx, RxPosition::Icao(_)) && is_reference;
        assert_eq!(place.is_some(), !is_aboard, "{rx:?}");
    }
}

#[test]
fn airspeed_and_heading_are_no_ground_speed_and_track() {
    let mut tracker = Tracker::<3>::new();
    hear(&mut tracker, &frame("8DA05F219B06B6AF189400CBC33F"), 0);
    let aircraft = tracker.find(icao(0xA05F21)).unwrap();
    assert_eq!(aircraft.heading(0).map(|heading| heading.0), Some(24_398));
    assert_eq!(aircraft.true_airspeed_kt(0), Some(375));
    assert_eq!(aircraft.indicated_airspeed_kt(0), None);
    assert_eq!(aircraft.track(0), None);
    assert_eq!(aircraft.ground_speed_eighths(0), None);
    assert_eq!(aircraft.nacv(0), Some(0));
}

#[test]
fn a_ground_station_changes_nothing_while_the_aircraft_is_heard_itself() {
    let at = |first, feet_code| squitter(first, 0x4B18FF, [0x58, feet_code, 0x80, 0, 0, 0, 0]);
    let mut tracker = Tracker::<3>::new();
    // TIS-B (CF 2) first, then the aircraft itself, then TIS-B and ADS-R (CF 6) again.
    let altitude = |tracker: &Tracker<3>, now_ms| {
        let aircraft = tracker.find(icao(0x4B18FF)).unwrap();
        aircraft.baro_altitude(now_ms).unwrap().0
    };
    hear(&mut tracker, &at(0x92, 0x39), 0);
    let by_radar = altitude(&tracker, 0);
    hear(&mut tracker, &at(0x8D, 0xB9), 1_000);
    assert_eq!(altitude(&tracker, 1_000), 36_000);
    assert_ne!(by_radar, 36_000);
    for (at_ms, first) in [(2_000, 0x92), (2_100, 0x95), (2_200, 0x96)] {
        hear(&mut tracker, &at(first, 0x39), at_ms);
        assert_eq!(altitude(&tracker, at_ms), 36_000);
    }
    // 20 s later only the ground station is left.
    for second in 3..=22 {
        tracker.each_second(second * 1_000);
    }
    hear(&mut tracker, &at(0x92, 0x39), 22_000);
    assert_eq!(altitude(&tracker, 22_000), by_radar);
}

#[test]
fn the_source_of_a_position_is_told() {
    for (first, source) in [
        (0x8D, PositionSource::Direct),
        (0x90, PositionSource::Direct),
        (0x92, PositionSource::Radar),
        (0x96, PositionSource::Rebroadcast),
    ] {
        let mut tracker = Tracker::<3>::new();
        for at in 0..4 {
            let bytes = frame(HAWAII[at % 2]);
            let mut me = [0; 7];
            me.copy_from_slice(&bytes.bytes()[4..11]);
            let position = squitter(first, 0xA6147F, me);
            hear(&mut tracker, &position, 400 * at as u64);
        }
        let aircraft = tracker.find(icao(0xA6147F)).unwrap();
        assert_eq!(aircraft.position_source(1_200), Some(source));
    }
}

/// Offers a published DF20 whose sender an all-call reply has named before.
fn hear_comm_b(tracker: &mut Tracker<3>, hex: &str, at_ms: u64) -> Address {
    let reply = frame(hex);
    let address = Message::decode(&reply).address().unwrap();
    hear(tracker, &all_call(address.bits()), at_ms);
    assert_eq!(hear(tracker, &reply, at_ms), Outcome::Updated);
    address
}

#[test]
fn comm_b_tells_callsign_and_selected_altitudes() {
    let mut tracker = Tracker::<3>::new();
    let address = hear_comm_b(&mut tracker, "A000083E202CC371C31DE0AA1CCF", 0);
    let callsign = tracker.find(address).unwrap().callsign().unwrap();
    assert_eq!(callsign.as_bytes(), b"KLM1017");
    let address = hear_comm_b(&mut tracker, "A000029C85E42F313000007047D3", 0);
    let aircraft = tracker.find(address).unwrap();
    assert_eq!(aircraft.selected_altitude_mcp(0), Some(AltitudeFt(3_008)));
    assert_eq!(aircraft.selected_altitude_fms(0), Some(AltitudeFt(3_008)));
    assert_eq!(aircraft.pressure_setting_tenths(0), Some(10_200));
    assert_eq!(aircraft.modes(0), None);
}

/// ME of a velocity over the ground: knots to the east and to the north, nothing else told.
fn velocity_me(east: i16, north: i16) -> [u8; 7] {
    let component = |knots: i16| u64::from(knots < 0) << 10 | u64::from(knots.unsigned_abs() + 1);
    let bits = 19u64 << 51 | 1 << 48 | component(east) << 32 | component(north) << 21;
    let [_, me @ ..] = bits.to_be_bytes();
    me
}

#[test]
fn comm_b_tells_turn_heading_and_speeds_beside_squitters_that_tell_the_track() {
    // Published 5,0: roll 2.1°, track 114.3°, 438 kt, 0.125°/s, TAS 424 kt; and 6,0: heading 42.7°, 252 kt, Mach 0.42, -1920 ft/min.
    const TURN: &str = "A000139381951536E024D4CCF6B5";
    const SPEED: &str = "A00004128F39F91A7E27C46ADC21";
    let aboard = |hex: &str| Message::decode(&frame(hex)).address().unwrap();
    for squitters in [false, true] {
        let mut tracker = Tracker::<3>::new();
        for hex in [TURN, SPEED] {
            // A velocity that belongs to both: 440 kt to 113°, or none.
            if squitters {
                let velocity = squitter(0x8D, aboard(hex).bits(), velocity_me(405, -172));
                hear(&mut tracker, &velocity, 0);
            }
            hear_comm_b(&mut tracker, hex, 100);
        }
        let turning = tracker.find(aboard(TURN)).unwrap();
        if squitters {
            assert_eq!(turning.roll_centidegrees(100), Some(211));
            assert_eq!(turning.track_rate_centidegrees(100), Some(12));
            assert_eq!(turning.true_airspeed_kt(100), Some(424));
            assert_eq!(turning.ground_speed_eighths(100), Some(440 * 8));
            let speed = tracker.find(aboard(SPEED)).unwrap();
            assert_eq!(speed.heading(100).map(|heading| heading.0), Some(4_271));
            assert_eq!(speed.indicated_airspeed_kt(100), Some(252));
            assert_eq!(speed.mach_thousandths(100), Some(420));
        } else if let Some(speed) = turning.ground_speed_eighths(100) {
            assert_eq!(speed, 438 * 8);
        }
    }
}
