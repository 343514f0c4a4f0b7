//! Positions from a fleet's Beast streams alone: what arrived where and when, solved by least squares, against where the aircraft were.

use std::collections::{HashMap, HashSet};
use tests::clients::Client;
use tests::reception::arrival::quantile;
use twin::beast_stream::Reader;
use twin::fleet::earth::{LIGHT_M_S, Place, distance_m, from_degrees, through_air_m};
use twin::fleet::site::{self, Site};
use twin::fleet::{Fleet, Options, Sent};
use twin::source::scene::aircraft::address_of;

/// Four receivers around the aircraft, 60 km apart, GPS stamps, crystals as they come.
const SITES: &str = "\
    north 52.90 13.40 60 1 gps offset=12 jitter=12\n\
    west  52.30 12.70 45 2 gps offset=-18 drift=2 jitter=12\n\
    east  52.45 14.20 50 3 gps offset=3 jitter=12\n\
    south 51.95 13.55 80 4 gps offset=-7 drift=-1 jitter=12\n";

const OPTIONS: Options = Options {
    aircraft: 24,
    place: (52.4, 13.5),
    silent: 0,
    speed_kt: None,
    squitters_a_second: 60,
    snr_db: 25.0,
    seed: 3,
};
/// A solution is asked for within so much of the middle: outside of the receivers the geometry multiplies every error.
const WITHIN_M: f64 = 60_000.0;

/// Frames with the second of arrival at each receiver, in the order of the sites.
fn heard(fleet: &mut Fleet, seconds: usize) -> Vec<(Sent, Vec<f64>)> {
    let mut readers: Vec<Reader> = Vec::new();
    let mut found = Vec::new();
    for _ in 0..seconds {
        let (sent, told) = fleet.second();
        readers.resize_with(told.len(), Reader::default);
        let mut arrivals: HashMap<Vec<u8>, Vec<f64>> = HashMap::new();
        for (reader, messages) in readers.iter_mut().zip(told) {
            let bytes: Vec<u8> = messages.into_iter().flat_map(|m| m.bytes).collect();
            for message in reader.read(&bytes) {
                // GPS form: seconds in the upper 18 bits, nanoseconds in the lower 30.
                let (second, ns) = (message.stamp >> 30, message.stamp & 0x3FFF_FFFF);
                let at = second as f64 + ns as f64 * 1e-9;
                arrivals.entry(message.bytes).or_default().push(at);
            }
        }
        for one in sent {
            if let Some(times) = arrivals.remove(one.frame.bytes())
                && times.len() == readers.len()
            {
                found.push((one, times));
            }
        }
    }
    found
}

/// Place and time of sending by Gauss-Newton, the height over the ellipsoid known from the frame: latitude, longitude, time.
fn solve(sites: &[Place], times: &[f64], height_m: f64) -> Option<Place> {
    let (mut latitude, mut longitude) = OPTIONS.place;
    let base = times[0];
    let mut sent_m = -50_000.0;
    for _ in 0..20 {
        let at = from_degrees(latitude, longitude, height_m);
        let step = 1e-5;
        let aside = [
            from_degrees(latitude + step, longitude, height_m),
            from_degrees(latitude, longitude + step, height_m),
        ];
        let mut normal = [[0.0; 4]; 3];
        for (site, time) in sites.iter().zip(times) {
            let way = |place| through_air_m(distance_m(*site, place), height_m);
            let range = way(at);
            let row = [
                (way(aside[0]) - range) / step,
                (way(aside[1]) - range) / step,
                1.0,
            ];
            let residual = (time - base) * LIGHT_M_S - (range + sent_m);
            for i in 0..3 {
                for j in 0..3 {
                    normal[i][j] += row[i] * row[j];
                }
                normal[i][3] += row[i] * residual;
            }
        }
        let change = eliminate(normal)?;
        latitude += change[0];
        longitude += change[1];
        sent_m += change[2];
        if change[0].abs() + change[1].abs() < 1e-9 {
            return Some(from_degrees(latitude, longitude, height_m));
        }
        if latitude.abs() > 89.0 {
            return None;
        }
    }
    None
}

fn eliminate(mut rows: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    for column in 0..3 {
        let pivot = rows[column];
        if pivot[column].abs() < 1e-12 {
            return None;
        }
        for (n, row) in rows.iter_mut().enumerate() {
            if n != column {
                let factor = row[column] / pivot[column];
                row.iter_mut()
                    .zip(pivot)
                    .for_each(|(value, from)| *value -= factor * from);
            }
        }
    }
    Some([0, 1, 2].map(|n| rows[n][3] / rows[n][n]))
}

fn places(sites: &[Site]) -> Vec<Place> {
    let place = |s: &Site| from_degrees(s.latitude, s.longitude, s.height_m);
    sites.iter().map(place).collect()
}

/// Horizontal errors, metres.
fn errors_m(text: &str, seconds: usize) -> Vec<f64> {
    let sites = site::parse(text).expect("sites");
    let mut fleet = Fleet::new(OPTIONS, &sites);
    let places = places(&sites);
    let middle = from_degrees(OPTIONS.place.0, OPTIONS.place.1, 0.0);
    let mut errors = Vec::new();
    for (sent, times) in heard(&mut fleet, seconds) {
        if distance_m(sent.place, middle) > WITHIN_M {
            continue;
        }
        let solved = solve(&places, &times, sent.height_m).expect("it converges");
        errors.push(distance_m(solved, sent.place));
    }
    errors
}

#[test]
fn four_receivers_with_gps_stamps_place_aircraft_within_25_m() {
    let errors = errors_m(SITES, 150);
    let (median, ninety) = (quantile(&errors, 0.5), quantile(&errors, 0.9));
    println!(
        "{} positions, median {median:.1} m, 90 % {ninety:.1} m",
        errors.len()
    );
    assert!(errors.len() > 300, "{}", errors.len());
    assert!(median <= 25.0, "{median}");
    assert!(ninety <= 90.0, "{ninety}");
}

#[test]
fn one_of_ours_against_references_of_another_make_is_within_200_ns() {
    // Pairs: the difference of two arrivals less that of the ways, against receivers whose stamps are exact.
    let text =
        SITES
            .replace("jitter=12\n", "make=reference\n")
            .replacen("make=reference", "jitter=15", 1);
    let sites = site::parse(&text).expect("sites");
    assert_eq!(sites.iter().filter(|s| s.is_reference).count(), 3);
    let mut fleet = Fleet::new(OPTIONS, &sites);
    let places = places(&sites);
    let mut errors = Vec::new();
    for (sent, times) in heard(&mut fleet, 20) {
        for other in 1..4 {
            let way = |n: usize| through_air_m(distance_m(places[n], sent.place), sent.height_m);
            let ways = way(0) - way(other);
            errors.push((times[0] - times[other] - ways / LIGHT_M_S) * 1e9);
        }
    }
    assert!(errors.len() > 1_000, "{}", errors.len());
    let worst = quantile(&errors, 0.999);
    println!(
        "pair error: median {:.0} ns, 99.9 % {worst:.0} ns",
        quantile(&errors, 0.5)
    );
    assert!(worst <= 200.0, "{worst}");
}

#[test]
fn aircraft_without_ads_b_answer_with_their_address_and_height() {
    let options = Options {
        silent: 8,
        speed_kt: Some(90.0),
        ..OPTIONS
    };
    let sites = site::parse(SITES).expect("sites");
    let mut fleet = Fleet::new(options, &sites);
    let mut kinds = std::collections::BTreeSet::new();
    let mut first: HashMap<usize, Sent> = HashMap::new();
    for _ in 0..4 {
        for one in fleet.second().0 {
            let bytes = one.frame.bytes();
            let df = bytes[0] >> 3;
            assert_eq!(df != 17, one.aircraft < 8);
            if df == 17 {
                continue;
            }
            kinds.insert(df);
            let address = address_of(one.aircraft);
            let residual = if df == 11 { 0 } else { address };
            assert_eq!(one.frame.residual(), residual);
            if df == 0 || df == 4 {
                let code = u32::from(bytes[2] & 0x1F) << 8 | u32::from(bytes[3]);
                // M 0, Q 1: steps of 25 ft in the other eleven bits.
                assert_eq!(code & 0x50, 0x10);
                let steps = (code & 0x1F80) >> 2 | (code & 0x20) >> 1 | code & 0xF;
                let feet = f64::from(steps * 25) - 1_000.0;
                assert!((feet * 0.3048 - one.height_m).abs() < 1.0, "{feet} ft");
            }
            let before = first.entry(one.aircraft).or_insert(one);
            let metres = distance_m(before.place, one.place);
            let seconds = (one.at_ps - before.at_ps) as f64 * 1e-12;
            let expected = 90.0 * 1_852.0 / 3_600.0 * seconds;
            assert!(
                (metres - expected).abs() < 1.0 + expected * 0.01,
                "{metres}"
            );
        }
    }
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), [0, 4, 5, 11]);
}

#[test]
fn the_streams_arrive_in_dump1090() {
    let text = SITES.replacen(" gps ", " 12mhz ", 2);
    let options = Options {
        silent: 6,
        ..OPTIONS
    };
    let sites = site::parse(&text).expect("sites");
    let mut fleet = Fleet::new(options, &sites);
    let mut streams = vec![Vec::new(); sites.len()];
    let mut frames = Vec::new();
    for _ in 0..8 {
        let (sent, told) = fleet.second();
        // With the address in the clear: the program wants to know an aircraft before it believes an overlaid one.
        frames.extend(sent.into_iter().filter(|one| one.frame.residual() == 0));
        for (stream, messages) in streams.iter_mut().zip(told) {
            stream.extend(messages.into_iter().flat_map(|m| m.bytes));
        }
    }
    for stream in &streams {
        let understood = Client::Dump1090Beast.read(stream);
        let came: HashSet<&str> = understood
            .iter()
            .filter_map(|told| told["frame"].as_str())
            .collect();
        for one in &frames {
            let hex: String = one
                .frame
                .bytes()
                .iter()
                .map(|b| format!("{b:02X}"))
                .collect();
            assert!(came.contains(hex.as_str()), "{hex} did not arrive");
        }
        println!("{} of {} arrived", came.len(), frames.len());
    }
}
