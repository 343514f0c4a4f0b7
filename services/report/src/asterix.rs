//! ASTERIX: CAT021 edition 2.1, a target report for each aircraft, and CAT023 edition 1.2, the ground station's status once a second.
//!
//! A data block holds one record. Items of CAT021, in the order of the profile; an unknown one is absent:
//!
//! | FRN | item | content | unit |
//! |---|---|---|---|
//! | 1 | 010 | SAC, SIC | |
//! | 2 | 040 | ATP: 0 ICAO address, 3 none; ARC: 0 where the altitude shows 25 ft steps, 2 unknown; GBS in a second octet on the ground | |
//! | 7 | 131 | position | 180/2^30 degrees |
//! | 9 | 150 | indicated airspeed, else Mach | 2^-14 NM/s, 0.001 |
//! | 10 | 151 | true airspeed | kt |
//! | 11 | 080 | address | |
//! | 12 | 073 | time at which the position was received | 1/128 s of the day |
//! | 14 | 075 | time at which the velocity was received | 1/128 s |
//! | 16 | 140 | height above the ellipsoid | 6.25 ft |
//! | 17 | 090 | NUCr or NACv, NUCp or NIC; NICbaro, SIL, NACp from version 1; SDA, GVA from version 2 | |
//! | 18 | 210 | version of ADS-B; 1090 ES | |
//! | 19 | 070 | Mode 3/A code | |
//! | 20 | 230 | roll, right wing down positive | 0.01° |
//! | 21 | 145 | flight level: pressure altitude | 1/4 FL |
//! | 22 | 152 | magnetic heading | 2^-16 turns |
//! | 23 | 200 | LNAV engaged (0) or not (1), priority status, surveillance status | |
//! | 24 | 155 | barometric vertical rate | 6.25 ft/min |
//! | 25 | 157 | geometric vertical rate | 6.25 ft/min |
//! | 26 | 160 | ground speed and track, in the air and on the surface | 2^-14 NM/s, 2^-16 turns |
//! | 27 | 165 | rate of turn, to the right positive | 1/32 °/s |
//! | 28 | 077 | time of this report | 1/128 s |
//! | 29 | 170 | target identification | six bits a character |
//! | 30 | 020 | emitter category | |
//! | 31 | 220 | wind, temperature, turbulence, as far as known | kt, °, 0.25 °C |
//! | 32 | 146 | selected altitude of the control panel, else of the FMS | 25 ft |
//! | 38 | 132 | amplitude | dBm |
//!
//! Not sent, because the tracker does not keep it or it would claim what is not known: 008, 015, 016, 071, 072, 074, 110, 130 (131 says it
//! better), 148, 161, 250, 260, 271, 295, 400. Times are absent while the time of day is unknown.
//!
//! Source: EUROCONTROL-SPEC-0149-12 edition 2.1 (CAT021) and SPEC-0149-16 edition 1.2 (CAT023).

use crate::Full;
use crate::asterix_record::Record;
use crate::ecat;
use crate::emergency;
use crate::moment::Moment;
use crate::text::whole_decibels;
use crate::units::turn_parts;
use mode_s::{AltitudeFt, Callsign, Position};
use tracker::{Aircraft, Field};

/// Octets of all items of CAT021 together, at most.
const MOST_ITEMS: usize = 84;
/// A slice that holds any data block of ours.
pub const MAX_BLOCK: usize = Record::<MOST_ITEMS>::MAX_BLOCK;

/// Who reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// System area code.
    pub sac: u8,
    /// System identification code.
    pub sic: u8,
}

impl Source {
    /// The documents' default for ADS-B.
    pub const ADSB: Source = Source { sac: 1, sic: 129 };
    /// The documents' fixed source of FLARM targets.
    pub const FLARM: Source = Source { sac: 0, sic: 161 };
}

type Target = Record<MOST_ITEMS>;

/// CAT021: one aircraft.
pub fn target(
    aircraft: &Aircraft,
    moment: &Moment,
    source: Source,
    out: &mut [u8],
) -> Result<usize, Full> {
    let mut record = Target::new(21);
    record.item(1, &[source.sac, source.sic]);
    descriptor(&mut record, aircraft, moment.now_ms);
    place(&mut record, aircraft, moment);
    quality(&mut record, aircraft, moment.now_ms);
    attitude(&mut record, aircraft, moment.now_ms);
    status(&mut record, aircraft, moment.now_ms);
    motion(&mut record, aircraft, moment);
    identity(&mut record, aircraft);
    weather_and_intent(&mut record, aircraft, moment.now_ms);
    if let Some(level) = aircraft.level_cdbm() {
        record.item(38, &[whole_decibels(level).clamp(-128, 127) as i8 as u8]);
    }
    record.block(out)
}

/// CAT023: the ground station's status. Its time source is invalid while the time of day is unknown.
pub fn station_status(moment: &Moment, source: Source, out: &mut [u8]) -> Result<usize, Full> {
    let mut record = Record::<16>::new(23);
    record.item(1, &[source.sac, source.sic]);
    // Ground station status message.
    record.item(2, &[1]);
    if let Some(ms) = moment.utc_ms {
        record.item(4, &time_of_day(ms));
    }
    // TSV: time source not valid.
    record.item(5, &[u8::from(moment.utc_ms.is_none()) << 3]);
    record.block(out)
}

/// 040.
fn descriptor(record: &mut Target, aircraft: &Aircraft, now_ms: u64) {
    let atp = if aircraft.address().is_icao() { 0 } else { 3 };
    // 25 ft steps show where the altitude is no multiple of 100 ft.
    let arc = match aircraft.baro_altitude(now_ms) {
        Some(AltitudeFt(feet)) if feet % 100 != 0 => 0,
        _ => 2,
    };
    let first = atp << 5 | arc << 3;
    if aircraft.on_ground() == Some(true) {
        // GBS.
        record.item(2, &[first | 1, 1 << 6]);
    } else {
        record.item(2, &[first]);
    }
}

/// 131, 150, 151, 080, 073, 075, 140.
fn place(record: &mut Target, aircraft: &Aircraft, moment: &Moment) {
    let now_ms = moment.now_ms;
    if let Some(Position {
        latitude,
        longitude,
    }) = aircraft.position(now_ms)
    {
        let [a, b, c, d] = fine_semicircles(latitude).to_be_bytes();
        let [e, f, g, h] = fine_semicircles(longitude).to_be_bytes();
        record.item(7, &[a, b, c, d, e, f, g, h]);
    }
    let indicated = aircraft.indicated_airspeed_kt(now_ms);
    let indicated = indicated.map(|knots| knot_parts(u32::from(knots) * 8));
    let mach = aircraft.mach_thousandths(now_ms).map(|mach| mach | 1 << 15);
    if let Some(speed) = indicated.or(mach) {
        record.item(9, &speed.to_be_bytes());
    }
    if let Some(knots) = aircraft.true_airspeed_kt(now_ms) {
        record.item(10, &knots.min(0x7FFF).to_be_bytes());
    }
    record.item(11, &aircraft.address().bits().to_be_bytes()[1..]);
    let heard = |field| {
        let age_ms = aircraft.age_ms(field, now_ms)?;
        moment.utc_ms_before(age_ms).map(time_of_day)
    };
    if aircraft.position(now_ms).is_some()
        && let Some(time) = heard(Field::Position)
    {
        record.item(12, &time);
    }
    if aircraft.ground_speed_eighths(now_ms).is_some()
        && let Some(time) = heard(Field::GroundSpeed)
    {
        record.item(14, &time);
    }
    if let Some(AltitudeFt(feet)) = aircraft.gnss_altitude(now_ms) {
        // 6.25 ft are a quarter of 25, rounded.
        record.item(16, &sixteen((feet * 4 + 12).div_euclid(25)));
    }
}

/// 090 and 210.
fn quality(record: &mut Target, aircraft: &Aircraft, now_ms: u64) {
    let version = aircraft.version().min(2);
    let nacv = aircraft.nacv(now_ms).unwrap_or(0);
    let integrity = match version {
        0 => aircraft.nucp(now_ms),
        _ => aircraft.nic(now_ms),
    };
    let first = nacv << 5 | integrity.unwrap_or(0) << 1;
    match (version, aircraft.status(now_ms)) {
        (1.., Some(status)) => {
            let second = u8::from(status.nic_baro()) << 7 | status.sil() << 5 | status.nac_p() << 1;
            let third = status.sda() << 3 | status.gva() << 1;
            match version {
                1 => record.item(17, &[first | 1, second]),
                _ => record.item(17, &[first | 1, second | 1, third]),
            }
        }
        _ => record.item(17, &[first]),
    }
    // VNS 0, version, 1090 ES.
    record.item(18, &[version << 3 | 2]);
}

/// 070, 230, 145, 152.
fn attitude(record: &mut Target, aircraft: &Aircraft, now_ms: u64) {
    if let Some(squawk) = aircraft.squawk() {
        record.item(19, &squawk.0.to_be_bytes());
    }
    if let Some(roll) = aircraft.roll_centidegrees(now_ms) {
        record.item(20, &roll.to_be_bytes());
    }
    if let Some(AltitudeFt(feet)) = aircraft.baro_altitude(now_ms) {
        record.item(21, &sixteen(feet.div_euclid(25)));
    }
    if let Some(heading) = aircraft.heading(now_ms)
        && aircraft.heading_is_magnetic()
    {
        record.item(22, &(turn_parts(heading.0, 16) as u16).to_be_bytes());
    }
}

/// 200.
fn status(record: &mut Target, aircraft: &Aircraft, now_ms: u64) {
    let lnav_off = !aircraft.modes(now_ms).is_some_and(|modes| modes.lnav);
    let priority = emergency::code(aircraft, now_ms);
    let is_emergency_code = aircraft
        .squawk()
        .is_some_and(|code| emergency::of_squawk(code) != 0);
    // Surveillance status: 3 SPI, 1 permanent alert (an emergency code), 2 temporary alert (the code has changed).
    let surveillance = match (aircraft.ident(now_ms), aircraft.alert(now_ms)) {
        (true, _) => 3,
        (false, true) if is_emergency_code => 1,
        (false, true) => 2,
        (false, false) => 0,
    };
    let octet = u8::from(lnav_off) << 6 | priority << 2 | surveillance;
    record.item(23, &[octet]);
}

/// 155, 157, 160, 165, 077.
fn motion(record: &mut Target, aircraft: &Aircraft, moment: &Moment) {
    let now_ms = moment.now_ms;
    if let Some(rate) = aircraft.vertical_rate(now_ms) {
        // 6.25 ft/min are a quarter of 25, rounded; fifteen bits.
        let [high, low] = sixteen((i32::from(rate.feet_per_minute) * 4 + 12).div_euclid(25));
        let frn = if rate.is_barometric { 24 } else { 25 };
        record.item(frn, &[high & 0x7F, low]);
    }
    let speed = aircraft.ground_speed_eighths(now_ms);
    if let (Some(speed), Some(track)) = (speed, aircraft.track(now_ms)) {
        let [a, b] = knot_parts(speed.into()).to_be_bytes();
        let [c, d] = (turn_parts(track.0, 16) as u16).to_be_bytes();
        record.item(26, &[a, b, c, d]);
    }
    if let Some(rate) = aircraft.track_rate_centidegrees(now_ms) {
        let steps = (i32::from(rate) * 32 / 100).clamp(-512, 511);
        let [high, low] = sixteen(steps);
        record.item(27, &[high & 3, low]);
    }
    if let Some(ms) = moment.utc_ms {
        record.item(28, &time_of_day(ms));
    }
}

/// 170 and 020.
fn identity(record: &mut Target, aircraft: &Aircraft) {
    if let Some(callsign) = aircraft.callsign() {
        record.item(29, &six_bit(&callsign));
    }
    if let Some(category) = aircraft.category() {
        record.item(30, &[ecat::asterix(category)]);
    }
}

/// 220 and 146.
fn weather_and_intent(record: &mut Target, aircraft: &Aircraft, now_ms: u64) {
    let wind = aircraft.wind(now_ms);
    let temperature = aircraft.temperature_centidegrees(now_ms);
    let turbulence = aircraft.turbulence(now_ms);
    let wind_present = if wind.is_some() { 0b1100_0000 } else { 0 };
    let present =
        wind_present | u8::from(temperature.is_some()) << 5 | u8::from(turbulence.is_some()) << 4;
    if present != 0 {
        let mut octets = [present; 8];
        let mut length = 1;
        let mut put = |bytes: &[u8]| {
            let places = octets.iter_mut().skip(length);
            places.zip(bytes).for_each(|(place, &byte)| *place = byte);
            length += bytes.len();
        };
        if let Some(wind) = wind {
            put(&wind.speed_kt.to_be_bytes());
            // 1 to 360 degrees.
            let degrees = match wind.direction.whole_degrees() {
                0 => 360,
                degrees => degrees,
            };
            put(&degrees.to_be_bytes());
        }
        if let Some(temperature) = temperature {
            put(&temperature.div_euclid(25).to_be_bytes());
        }
        if let Some(turbulence) = turbulence {
            put(&[turbulence]);
        }
        record.item(31, &octets[..length]);
    }
    let panel = aircraft.selected_altitude_mcp(now_ms);
    let selected = panel
        .map(|altitude| (2, altitude))
        .or_else(|| Some((3, aircraft.selected_altitude_fms(now_ms)?)));
    if let Some((source, AltitudeFt(feet))) = selected {
        // Source provided, which, thirteen bits of 25 ft.
        let [high, low] = sixteen(feet.div_euclid(25));
        record.item(32, &[0x80 | source << 5 | high & 0x1F, low]);
    }
}

/// 180/2^30 degrees in an angle of 1e-7 degrees, rounded.
fn fine_semicircles(angle: i32) -> i32 {
    // 180e7 is 2^9 × 3 515 625; at most 31 bits, signed.
    ((i64::from(angle) << 21) + 1_757_812).div_euclid(3_515_625) as i32
}

/// 2^-14 NM/s in eighths of a knot, rounded: 256/450 of an eighth; at most fifteen bits.
fn knot_parts(eighths: u32) -> u16 {
    // 2^14 / (8 × 3600) = 128/225.
    ((eighths * 128 + 112) / 225).min(0x7FFF) as u16
}

/// Two octets, two's complement.
fn sixteen(value: i32) -> [u8; 2] {
    (value.clamp(i16::MIN.into(), i16::MAX.into()) as i16).to_be_bytes()
}

/// 128ths of a second of the day, three octets.
fn time_of_day(ms: u32) -> [u8; 3] {
    let [_, a, b, c] = (ms * 16 / 125).to_be_bytes();
    [a, b, c]
}

/// Eight characters of six bits, spaces at the end: the low six bits of ASCII.
fn six_bit(callsign: &Callsign) -> [u8; 6] {
    let characters = callsign.as_bytes().iter().chain(core::iter::repeat(&b' '));
    let packed = characters
        .take(8)
        .fold(0u64, |word, &byte| word << 6 | u64::from(byte & 0x3F));
    let [_, _, a, b, c, d, e, f] = packed.to_be_bytes();
    [a, b, c, d, e, f]
}

#[cfg(test)]
#[path = "asterix_tests.rs"]
mod tests;
