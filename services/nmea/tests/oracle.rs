//! The same sentences read by the `nmea` crate: an independent opinion, in floating point.

use nmea::{Nmea, ParseResult};
use nmea_0183::Sentence;

fn whole(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}")
}

/// Degrees and minutes of a pseudo-random place, both signs.
fn places() -> impl Iterator<Item = (String, String)> {
    (0..500u64).map(|n| {
        let word = n.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let (a, b) = (word >> 40, word >> 12 & 0xFF_FFFF);
        let latitude = format!(
            "{:02}{:02}.{:05},{}",
            a % 90,
            b % 60,
            word % 100_000,
            ["N", "S"][n as usize % 2]
        );
        let longitude = format!(
            "{:03}{:02}.{:05},{}",
            b % 180,
            a % 60,
            word / 7 % 100_000,
            ["E", "W"][n as usize / 2 % 2]
        );
        (latitude, longitude)
    })
}

#[test]
fn positions_heights_and_speeds_agree() {
    for (n, (latitude, longitude)) in places().enumerate() {
        let gga = whole(&format!(
            "GNGGA,123519.00,{latitude},{longitude},1,08,0.9,{}.4,M,46.9,M,,",
            n * 3
        ));
        let Sentence::Gga(ours) = Sentence::parse(gga.as_bytes()) else {
            panic!("{gga}");
        };
        let theirs = match nmea::parse_str(&gga) {
            Ok(ParseResult::GGA(theirs)) => theirs,
            other => panic!("{gga}: {other:?}"),
        };
        let (our_latitude, our_longitude) = ours.position.expect("a position");
        let near = |ours: i32, theirs: Option<f64>| {
            let theirs = theirs.expect("a value");
            assert!(
                (f64::from(ours) * 1e-7 - theirs).abs() < 6e-8,
                "{gga}: {ours} {theirs}"
            );
        };
        near(our_latitude, theirs.latitude);
        near(our_longitude, theirs.longitude);
        let height = f64::from(ours.height_cm.expect("a height")) / 100.0;
        assert!((height - f64::from(theirs.altitude.expect("a height"))).abs() < 0.01);

        let rmc = whole(&format!(
            "GNRMC,123519.00,A,{latitude},{longitude},{}.345,271.8,230326,,,A",
            n
        ));
        let Sentence::Rmc(ours) = Sentence::parse(rmc.as_bytes()) else {
            panic!("{rmc}");
        };
        let theirs = match nmea::parse_str(&rmc) {
            Ok(ParseResult::RMC(theirs)) => theirs,
            other => panic!("{rmc}: {other:?}"),
        };
        let speed = ours.speed_millikt.expect("a speed") as f32 / 1000.0;
        assert!((speed - theirs.speed_over_ground.expect("a speed")).abs() < 0.002);
        let date = ours.date.expect("a date");
        let text = format!("{:04}-{:02}-{:02}", date.year, date.month, date.day);
        assert_eq!(text, theirs.fix_date.expect("a date").to_string());
        assert_eq!(ours.time.expect("a time").second_of_day, 45_319);
    }
}

#[test]
fn both_refuse_a_wrong_checksum() {
    let line = whole("GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,");
    for at in 1..line.len() - 3 {
        let mut wrong = line.clone().into_bytes();
        wrong[at] ^= 1;
        let mut reader = nmea_0183::Reader::new();
        let ours = wrong
            .iter()
            .chain(b"\r\n")
            .any(|&byte| reader.feed(byte).is_some());
        let theirs =
            std::str::from_utf8(&wrong).is_ok_and(|text| Nmea::default().parse(text).is_ok());
        assert!(!ours && !theirs, "{at}");
    }
}
