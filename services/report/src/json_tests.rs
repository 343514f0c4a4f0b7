//! Messages byte by byte.

use super::*;
use crate::Gnss;
use crate::test_aircraft::{after, airliner, frame};
use mode_s::{CentiDegrees, Position};
use std::string::String;

const AT: Moment = Moment {
    now_ms: 1000,
    utc_ms: Some(69_061_337),
};

fn sent(make: impl Fn(&mut [u8]) -> Result<usize, Full>) -> String {
    let mut out = [0; MAX_AIRCRAFT];
    let length = make(&mut out).unwrap();
    String::from_utf8(out[..length].to_vec()).unwrap()
}

#[test]
fn raw_frames_with_and_without_reception() {
    let frame = frame("5D4B18FFFC710B");
    let mut report = FrameReport::of_frame(&frame, 0);
    assert_eq!(
        sent(|out| raw("ID-0000001", &report, &AT, out)),
        "{\"src\":\"ID-0000001\",\"ts\":69061337,\"ver\":1,\"raw\":[[\"5D4B18FFFC710B\",null,null,null]]}\r\n"
    );
    report.level_cdbm = Some(-7_800);
    report.quality_cdb = Some(200);
    report.times.utc_second = Some(45_477);
    report.times.since_pps_ns = Some(988_350_583);
    assert_eq!(
        sent(|out| raw("1", &report, &Moment::at(5), out)),
        "{\"src\":\"1\",\"ver\":1,\"raw\":[[\"5D4B18FFFC710B\",-78,2,\"295CAB573A77\"]]}\r\n"
    );
}

#[test]
fn status_and_text_that_needs_escapes() {
    assert_eq!(
        sent(|out| status("a\"b\\c\n", "3.9.3.679 (Jan 15 2021)", &Moment::at(0), out)),
        "{\"src\":\"a\\\"b\\\\c\",\"ver\":1,\"status\":{\"fw\":\"3.9.3.679 (Jan 15 2021)\"}}\r\n"
    );
}

#[test]
fn statistics_leave_out_what_is_not_known() {
    let mut told = Statistics {
        enabled_s: 134,
        uptime_s: 200,
        ..Statistics::default()
    };
    assert_eq!(
        sent(|out| system_statistics("1", &told, &Moment::at(0), out)),
        "{\"src\":\"1\",\"ver\":1,\"systemStatistics\":{\"upt\":134,\"uptime\":200}}\r\n"
    );
    assert_eq!(
        sent(|out| adsb_statistics("1", &told, &Moment::at(0), out)),
        "{\"src\":\"1\",\"ver\":1,\"adsbStatistics\":{}}\r\n"
    );
    told.load_permille = Some(121);
    told.demodulations = Some(106);
    told.mode_s_frames = Some(3);
    told.mode_ac_frames = Some(20);
    told.stamp_clock_hz = Some(119_999_415);
    told.aircraft = Some(17);
    told.sent = Some(40);
    told.dropped = Some(2);
    assert_eq!(
        sent(|out| system_statistics("1", &told, &Moment::at(0), out)),
        "{\"src\":\"1\",\"ver\":1,\"systemStatistics\":{\"cpl\":12.1,\"upt\":134,\"uptime\":200,\"sent\":40,\"dropped\":2}}\r\n"
    );
    assert_eq!(
        sent(|out| adsb_statistics("1", &told, &Moment::at(0), out)),
        "{\"src\":\"1\",\"ver\":1,\"adsbStatistics\":{\"dps\":106,\"fpss\":3,\"fpsac\":20,\"calib\":119999415,\"aircraft\":17}}\r\n"
    );
}

#[test]
fn the_gnss_section() {
    assert_eq!(
        sent(|out| gnss("1", &Gnss::default(), &Moment::at(0), out)),
        "{\"src\":\"1\",\"ver\":1,\"gnss\":{\"fix\":0}}\r\n"
    );
    let told = Gnss {
        has_fix: true,
        position: Some(Position {
            latitude: 534_285_400,
            longitude: 145_528_101,
        }),
        ellipsoid_cm: Some(49_960),
        sea_level_cm: Some(-50),
        track: Some(CentiDegrees(12_730)),
        speed_centiknots: Some(1_050),
        climb_cm_s: Some(-2_500),
        latitude_error_cm: Some(520),
        longitude_error_cm: Some(210),
        height_error_cm: Some(360),
    };
    // 10.5 kt towards 127.3°: 8.35 kt to the east, 6.36 to the south.
    assert_eq!(
        sent(|out| gnss("1", &told, &AT, out)),
        "{\"src\":\"1\",\"ts\":69061337,\"ver\":1,\"gnss\":{\"fix\":1,\"lat\":53.42854,\"lon\":14.5528101,\"altWgs84\":499.6,\"altMsl\":-0.5,\
         \"track\":127.3,\"hVelo\":10.5,\"vVelo\":-25,\"gndSpeed\":[8.35,-6.36],\"acc\":{\"lat\":5.2,\"lon\":2.1,\"alt\":3.6},\"nacp\":9}}\r\n"
    );
}

#[test]
fn an_aircraft_known_by_address_alone() {
    let aircraft = after(&["5D4B18FFFC710B"]);
    assert_eq!(
        sent(|out| super::aircraft("1", &aircraft, &AT, Profile::Sf1, out)),
        "{\"src\":\"1\",\"ts\":69061337,\"ver\":1,\"adsb\":[{\"icao\":\"4B18FF\",\"sigStr\":-71,\"sigQ\":5,\"fps\":1}]}\r\n"
    );
    assert_eq!(
        sent(|out| super::aircraft("1", &aircraft, &AT, Profile::Sg1a, out)),
        "{\"src\":\"1\",\"ts\":69061337,\"ver\":1,\"adsb\":[{\"icao\":\"4B18FF\",\"flags\":{\"groundState\":false,\"updAltBaro\":false,\
         \"updAltGeo\":false,\"updPosition\":false,\"updTrack\":false,\"updVeloH\":false,\"updVeloV\":false},\"sigStr\":-71,\"sigQ\":5}]}\r\n"
    );
}

#[test]
fn the_profiles_names_do_not_mix() {
    let aircraft = airliner();
    let sg1a = sent(|out| super::aircraft("1", &aircraft, &AT, Profile::Sg1a, out));
    let sf1 = sent(|out| super::aircraft("1", &aircraft, &AT, Profile::Sf1, out));
    let names = |text: &str, names: &[&str]| {
        names
            .iter()
            .filter(|name| text.contains(&std::format!("\"{name}\":")))
            .count()
    };
    let of_sg1a = ["altBaro", "velH", "velV", "call", "flags", "nav_modes"];
    let of_sf1 = ["baroAlt", "hVelo", "vVelo", "ident", "fps"];
    assert_eq!((names(&sg1a, &of_sg1a), names(&sg1a, &of_sf1)), (6, 0));
    assert_eq!((names(&sf1, &of_sg1a), names(&sf1, &of_sf1)), (0, 5));
    // 182.88° in one, -177.12° in the other.
    assert!(sg1a.contains("\"track\":182.88,"), "{sg1a}");
    assert!(sf1.contains("\"track\":-177.12,"), "{sf1}");
}

#[test]
fn an_aircrafts_stamps_are_its_last_frames() {
    use crate::test_aircraft::hear;
    let told = |since_pps_ns, moment: Moment| {
        let mut tracker = tracker::Tracker::<4>::new();
        let heard = tracker::Heard {
            since_pps_ns,
            ..tracker::Heard::at(800)
        };
        hear(&mut tracker, &frame("5D4B18FFFC710B"), heard);
        tracker.each_second(1000);
        let aircraft = *tracker.aircraft().next().unwrap();
        sent(|out| super::aircraft("1", &aircraft, &moment, Profile::Sg1a, out))
    };
    // 200 ms ago, on the far side of a second's end.
    let at = |utc_ms| Moment {
        now_ms: 1000,
        utc_ms: Some(utc_ms),
    };
    let ns = Some(988_350_583);
    assert!(told(ns, at(69_061_188)).contains(",\"ts1s\":988350583,\"ts24h\":69060988350583}"));
    assert!(told(ns, at(1_188)).contains(",\"ts1s\":988350583,\"ts24h\":988350583}"));
    assert!(told(Some(5), at(2_200)).contains(",\"ts1s\":5,\"ts24h\":2000000005}"));
    assert!(told(ns, Moment::at(1000)).contains(",\"ts1s\":988350583}"));
    assert!(!told(None, at(69_061_188)).contains("ts1s"));
}
