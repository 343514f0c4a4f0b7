//! ASTERIX, read by libasterix in the strict editions, and by asterix-decoder as a second opinion.

use crate::compare::{Say, Told, assert_seen, compare, is, told};
use crate::samples::{self, Sample};
use crate::tables;
use report::asterix::{self, MAX_BLOCK, Source};
use report::{DAY_MS, Moment};
use tests::clients::Client;
use tracker::{Aircraft, Field};

/// Puts items into a record.
struct Record(Told);

impl Record {
    fn put(&mut self, name: &str, say: Say) {
        self.0.insert(name.into(), say);
    }

    fn maybe<T>(&mut self, name: &str, value: Option<T>, say: impl FnOnce(T) -> Say) {
        if let Some(value) = value {
            self.put(name, say(value));
        }
    }
}

/// 1/128 s, cut off; what happened `age_ms` before may be on the day before.
fn time(moment: &Moment, age_ms: u32) -> Option<Say> {
    let ms = (i64::from(moment.utc_ms?) - i64::from(age_ms)).rem_euclid(i64::from(DAY_MS));
    Some(is((ms as f64 / 1_000.0 * 128.0).floor() / 128.0))
}

/// Degrees within half a step of so many to a turn; a full turn is none.
fn turn(centidegrees: u16) -> Say {
    let step = 360.0 / 65_536.0;
    // tshark prints fifteen digits.
    Say::Near(
        (f64::from(centidegrees) / 100.0 / step).round() % 65_536.0 * step,
        1e-9,
    )
}

/// Knots in NM/s within half of 2^-14.
fn knots(knots: f64) -> Say {
    Say::Near(knots / 3_600.0, 0.5001 / 16_384.0)
}

fn place(record: &mut Record, Sample { aircraft, moment }: &Sample) {
    let now_ms = moment.now_ms;
    let half_step = 90.0 / f64::from(1 << 30) * 1.01;
    if let Some(place) = aircraft.position(now_ms) {
        record.put(
            "131/LAT",
            Say::Near(f64::from(place.latitude) * 1e-7, half_step),
        );
        record.put(
            "131/LON",
            Say::Near(f64::from(place.longitude) * 1e-7, half_step),
        );
        let age_ms = aircraft.age_ms(Field::Position, now_ms);
        if let Some(time) = age_ms.and_then(|age_ms| time(moment, age_ms)) {
            record.put("073", time);
        }
    }
    let age_ms = aircraft.age_ms(Field::GroundSpeed, now_ms);
    if aircraft.ground_speed_eighths(now_ms).is_some()
        && let Some(time) = age_ms.and_then(|age_ms| time(moment, age_ms))
    {
        record.put("075", time);
    }
    if let Some(time) = time(moment, 0) {
        record.put("077", time);
    }
    record.maybe("140", aircraft.gnss_altitude(now_ms), |feet| {
        Say::Near(feet.0.into(), 6.25)
    });
    record.maybe("145", aircraft.baro_altitude(now_ms), |feet| {
        is((f64::from(feet.0) / 25.0).floor() / 4.0)
    });
}

fn speeds(record: &mut Record, Sample { aircraft, moment }: &Sample) {
    let now_ms = moment.now_ms;
    let indicated = aircraft.indicated_airspeed_kt(now_ms);
    let mach = aircraft.mach_thousandths(now_ms);
    if let Some(speed) = indicated {
        record.put("150/IM", is(0));
        record.put("150/AS", knots(speed.into()));
    } else if let Some(mach) = mach {
        record.put("150/IM", is(1));
        record.put("150/AS", Say::Near(f64::from(mach) / 1_000.0, 1e-9));
    }
    if let Some(speed) = aircraft.true_airspeed_kt(now_ms) {
        record.put("151/RE", is(0));
        record.put("151/TAS", is(speed));
    }
    let heading = aircraft
        .heading(now_ms)
        .filter(|_| aircraft.heading_is_magnetic());
    record.maybe("152", heading, |heading| turn(heading.0));
    if let Some(rate) = aircraft.vertical_rate(now_ms) {
        let (item, name) = if rate.is_barometric {
            ("155", "BVR")
        } else {
            ("157", "GVR")
        };
        record.put(&format!("{item}/RE"), is(0));
        record.put(
            &format!("{item}/{name}"),
            Say::Near(rate.feet_per_minute.into(), 6.25),
        );
    }
    if let (Some(speed), Some(track)) = (
        aircraft.ground_speed_eighths(now_ms),
        aircraft.track(now_ms),
    ) {
        record.put("160/RE", is(0));
        record.put("160/GS", knots(f64::from(speed) / 8.0));
        record.put("160/TA", turn(track.0));
    }
    record.maybe("230", aircraft.roll_centidegrees(now_ms), |roll| {
        Say::Near(f64::from(roll) / 100.0, 1e-9)
    });
    let rate = aircraft.track_rate_centidegrees(now_ms);
    record.maybe("165/TAR", rate, |rate| {
        Say::Near((f64::from(rate) / 100.0).clamp(-16.0, 15.97), 1.0 / 32.0)
    });
}

/// Version-dependent quality: 090 grows with the version.
fn quality(record: &mut Record, aircraft: &Aircraft, now_ms: u64) {
    let version = aircraft.version().min(2);
    record.put("090/NUCRNACV", is(aircraft.nacv(now_ms).unwrap_or(0)));
    let integrity = if version == 0 {
        aircraft.nucp(now_ms)
    } else {
        aircraft.nic(now_ms)
    };
    record.put("090/NUCPNIC", is(integrity.unwrap_or(0)));
    if let (1.., Some(status)) = (version, aircraft.status(now_ms)) {
        record.put("090/NICBARO", is(u8::from(status.nic_baro())));
        record.put("090/SIL", is(status.sil()));
        record.put("090/NACP", is(status.nac_p()));
        if version == 2 {
            record.put("090/SILS", is(0));
            record.put("090/SDA", is(status.sda()));
            record.put("090/GVA", is(status.gva()));
        }
    }
    record.put("210/VNS", is(0));
    record.put("210/VN", is(version));
    record.put("210/LTT", is(2));
}

fn state(record: &mut Record, aircraft: &Aircraft, now_ms: u64) {
    record.put(
        "040/ATP",
        is(if aircraft.address().is_icao() { 0 } else { 3 }),
    );
    let fine = aircraft
        .baro_altitude(now_ms)
        .is_some_and(|feet| feet.0 % 100 != 0);
    record.put("040/ARC", is(if fine { 0 } else { 2 }));
    record.put("040/RC", is(0));
    record.put("040/RAB", is(0));
    if aircraft.on_ground() == Some(true) {
        for (name, value) in [
            ("DCR", 0),
            ("GBS", 1),
            ("SIM", 0),
            ("TST", 0),
            ("SAA", 0),
            ("CL", 0),
        ] {
            record.put(&format!("040/{name}"), is(value));
        }
    }
    let emergency_code = matches!(
        tables::squawk(aircraft).as_deref(),
        Some("7500" | "7600" | "7700")
    );
    let surveillance = match (aircraft.ident(now_ms), aircraft.alert(now_ms)) {
        (true, _) => 3,
        (_, true) if emergency_code => 1,
        (_, true) => 2,
        _ => 0,
    };
    record.put("200/ICF", is(0));
    record.put(
        "200/LNAV",
        is(u8::from(
            !aircraft.modes(now_ms).is_some_and(|modes| modes.lnav),
        )),
    );
    record.put("200/PS", is(tables::emergency(aircraft, now_ms)));
    record.put("200/SS", is(surveillance));
}

fn rest(record: &mut Record, aircraft: &Aircraft, now_ms: u64) {
    record.put("080", is(aircraft.address().bits()));
    record.maybe("070/MODE3A", tables::squawk(aircraft), is);
    record.maybe("170", tables::callsign(aircraft), |callsign| {
        is(format!("{callsign:<8}"))
    });
    record.maybe("020", aircraft.category(), |category| {
        is(tables::asterix(category))
    });
    let level = aircraft
        .level_cdbm()
        .map(|level| (f64::from(level) / 100.0 + 0.5).floor());
    record.maybe("132", level, is);
    if let Some(wind) = aircraft.wind(now_ms) {
        record.put("220/WS", is(wind.speed_kt));
        record.put(
            "220/WD",
            Say::Near(
                f64::from(wind.direction.0) / 100.0
                    + if wind.direction.0 < 50 { 360.0 } else { 0.0 },
                0.5,
            ),
        );
    }
    record.maybe("220/TMP", aircraft.temperature_centidegrees(now_ms), |t| {
        Say::Near(f64::from(t) / 100.0, 0.25)
    });
    record.maybe("220/TRB", aircraft.turbulence(now_ms), is);
    let panel = aircraft.selected_altitude_mcp(now_ms).map(|feet| (2, feet));
    let selected = panel.or(aircraft.selected_altitude_fms(now_ms).map(|feet| (3, feet)));
    if let Some((source, feet)) = selected {
        record.put("146/SAS", is(1));
        record.put("146/S", is(source));
        record.put("146/ALT", Say::Near(feet.0.into(), 24.9));
    }
}

fn target(sample: &Sample) -> Told {
    let Sample { aircraft, moment } = sample;
    let mut record = Record(told([
        ("category", is(21)),
        ("010/SAC", is(1)),
        ("010/SIC", is(129)),
    ]));
    place(&mut record, sample);
    speeds(&mut record, sample);
    quality(&mut record, aircraft, moment.now_ms);
    state(&mut record, aircraft, moment.now_ms);
    rest(&mut record, aircraft, moment.now_ms);
    record.0
}

fn station(moment: &Moment) -> Told {
    let mut record = Record(told([
        ("category", is(23)),
        ("010/SAC", is(0)),
        ("010/SIC", is(161)),
        ("000", is(1)),
    ]));
    if let Some(time) = time(moment, 0) {
        record.put("070", time);
    }
    for name in ["NOGO", "ODP", "OXT", "MSC", "SPO", "RN"] {
        record.put(&format!("100/{name}"), is(0));
    }
    record.put("100/TSV", is(u8::from(moment.utc_ms.is_none())));
    record.0
}

fn everything() -> (Vec<u8>, Vec<Told>) {
    let (mut stream, mut expected) = (Vec::new(), Vec::new());
    let mut out = [0; MAX_BLOCK];
    for sample in &samples::all() {
        let length = asterix::target(&sample.aircraft, &sample.moment, Source::ADSB, &mut out)
            .expect("it fits");
        stream.extend(&out[..length]);
        expected.push(target(sample));
    }
    for utc_ms in [None, Some(0), Some(DAY_MS - 1)] {
        let moment = Moment { now_ms: 0, utc_ms };
        let length = asterix::station_status(&moment, Source::FLARM, &mut out).expect("it fits");
        stream.extend(&out[..length]);
        expected.push(station(&moment));
    }
    (stream, expected)
}

#[test]
fn libasterix_reads_every_field_of_the_strict_editions() {
    let (stream, expected) = everything();
    let names = [
        "131/LAT",
        "073",
        "075",
        "077",
        "140",
        "145",
        "150/AS",
        "151/TAS",
        "152",
        "155/BVR",
        "160/GS",
        "230",
        "090/GVA",
        "070/MODE3A",
        "170",
        "020",
        "132",
        "146/ALT",
        "040/GBS",
    ];
    assert_seen(&expected, &names);
    compare("libasterix", &expected, &Client::Asterix.read(&stream));
}

/// Only what both name: at least so many fields.
fn second_opinion(name: &str, client: Client, at_least: usize) {
    let (stream, mut expected) = everything();
    let understood = client.read(&stream);
    let mut known = std::collections::BTreeSet::new();
    for message in &understood {
        known.extend(message.as_object().expect("an object").keys().cloned());
    }
    assert!(known.len() >= at_least, "{known:?}");
    for record in &mut expected {
        record.retain(|name, _| known.contains(name));
    }
    compare(name, &expected, &understood);
}

#[test]
fn asterix_decoder_reads_the_same() {
    second_opinion("asterix-decoder", Client::AsterixDecoder, 30);
}

#[test]
fn tshark_reads_the_same() {
    let (_, expected) = everything();
    let mut names = std::collections::BTreeSet::new();
    names.extend(expected.iter().flat_map(|record| record.keys()));
    second_opinion("tshark", Client::Tshark, names.len());
}
