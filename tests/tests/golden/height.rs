//! Which code do TC 20-22 use for GNSS height? "The 1090 Megahertz Riddle" and pyModeS read twelve bits of metres; this project and both
//! peers read the code of barometric altitudes. The lax log decides it: one aircraft alternates TC 11, TC 19 and TC 22.
//!
//! ```text
//!   TC 11   AC 268, Gillham      4500 ft
//!   TC 19   GNSS-baro             225 ft
//!   TC 22   AC 1D5, as altitude  4725 ft      as metres 469 m = 1539 ft
//! ```

use mode_s::{AltitudeFt, AltitudeSource, Body, Me, Message, Parity};
use std::collections::HashMap;
use tests::logs::Log;

/// Barometric altitude in steps of 100 ft, the difference and the height in steps of 25 ft: half of each may be lost.
const QUANTUM_FT: i32 = 75;

/// What was last heard of an aircraft.
#[derive(Default)]
struct Heard {
    baro: Option<i32>,
    difference: Option<i32>,
}

#[test]
fn heights_of_type_codes_20_to_22_are_altitude_plus_gnss_baro_difference() {
    let mut aircraft: HashMap<u32, Heard> = HashMap::new();
    let mut heights = 0;
    for heard in Log::Lax.read() {
        let message = Message::decode(&heard.frame);
        let (Parity::Exact(address), Body::ExtendedSquitter { me, .. }) =
            (message.parity, message.body)
        else {
            continue;
        };
        let last = aircraft.entry(address.bits()).or_default();
        match me {
            Me::Velocity(velocity) => {
                let difference = velocity.gnss_minus_baro_ft.map(i32::from);
                last.difference = difference.or(last.difference);
            }
            Me::AirbornePosition(position) => {
                match position.altitude.map(|a| (a.source, a.altitude)) {
                    Some((AltitudeSource::Barometric, AltitudeFt(feet))) => last.baro = Some(feet),
                    Some((AltitudeSource::Gnss, AltitudeFt(feet))) => {
                        let expected = last.baro.unwrap() + last.difference.unwrap();
                        let away = (feet - expected).abs();
                        assert!(away <= QUANTUM_FT, "{feet} ft, expected {expected} ft");
                        heights += 1;
                    }
                    None => {}
                }
            }
            _ => {}
        }
    }
    assert_eq!(heights, 5, "GNSS heights in the log");
}
