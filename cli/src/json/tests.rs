//! Names, units and the help: objects of published frames, and no field that the help does not list.

use super::*;
use mode_s::{Df, Frame, crc24};
use std::collections::BTreeSet;

fn bytes_of(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2)
        .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
        .collect()
}

fn fields_of(bytes: &[u8]) -> Map<String, Value> {
    let message = Message::decode(&Frame::from_bytes(bytes).unwrap());
    match object("", None, &message, None) {
        Value::Object(fields) => fields,
        other => panic!("{other}"),
    }
}

/// The JSON of a frame, its fields in the order of their names.
fn line(hex: &str) -> String {
    let mut fields = fields_of(&bytes_of(hex));
    for common in ["frame", "df", "crc", "icao", "kind"] {
        assert!(fields.remove(common).is_some(), "{common}");
    }
    let mut fields: Vec<String> = fields
        .iter()
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    fields.sort();
    fields.join(" ")
}

/// The names in the help text.
fn names() -> BTreeSet<&'static str> {
    FIELDS
        .lines()
        .filter_map(|line| line.split_once("  "))
        .flat_map(|(names, _)| names.split(", "))
        .collect()
}

#[test]
fn target_state_has_the_names_of_pymodes() {
    assert_eq!(
        line("8DA05629EA21485CBF3F8CADAEEB"),
        "altitude_hold_mode=false approach_mode=false autopilot=true baro_pressure_setting=1012.8 bds=\"6,2\" capability=5 \
         capability_text=\"level 2 or more, airborne\" crc_valid=true epu=30 lnav_mode=true nac_p=9 nic_baro=1 \
         on_ground=false pe_rcu=1e-7 selected_altitude=16992 selected_altitude_source=\"MCP/FCU\" selected_heading=66.8 \
         sil=3 sil_supplement=0 subtype=1 tcas_operational=true typecode=29 vepu=45 vnav_mode=true"
    );
}

#[test]
fn operational_status_on_the_surface() {
    assert_eq!(
        line("8C486257F9008602884A38A97BC2"),
        "antenna_behind_nose=14 antenna_lateral=0 b2_low=false bds=\"6,5\" capability=4 \
         capability_class=134 capability_text=\"level 2 or more, on ground\" crc_valid=true epu=10 es1090_in=false \
         hfom_r=0.3 hrd=0 ident_switch=false length=45.0 nac_p=10 nac_v=4 nic_supplement_a=0 nic_supplement_c=0 \
         on_ground=true operational_mode=648 pe_rcu=1e-7 position_offset_applied=false sda=2 sil=3 sil_supplement=0 \
         single_antenna=false subtype=1 tcas_ra=false trk_hdg=1 typecode=31 uat_in=false vepu=15 version=2 \
         vfom_r=0.46 width=39.5"
    );
}

#[test]
fn emergency_status_names_state_and_squawk() {
    assert_eq!(
        line("8DA2C1B6E112B600000000760759"),
        "bds=\"6,1\" capability=5 capability_text=\"level 2 or more, airborne\" crc_valid=true emergency_state=0 \
         emergency_state_text=\"none\" on_ground=false squawk=\"6513\" subtype=1 typecode=28"
    );
}

#[test]
fn a_register_has_the_names_of_pymodes() {
    assert_eq!(
        line("A000139381951536E024D4CCF6B5"),
        "alert=false altitude=30275 bds=\"5,0\" downlink_request=0 flight_status=0 flight_status_text=\"airborne\" \
         groundspeed=438 mb=\"81951536E024D4\" on_ground=false roll=2.109375 spi=false track_rate=0.125 true_airspeed=424 \
         true_track=114.26 um_interrogator=0 um_reservation=0 utility_message=0"
    );
}

/// Every field of every kind of frame that this decodes, with zeros, ones and noise in it.
#[test]
fn the_help_lists_every_field() {
    let names = names();
    let mut seen = BTreeSet::new();
    let mut noise: u64 = 1;
    for first in 0..=255u8 {
        for fifth in 0..=255u8 {
            for fill in [0x00, 0xFF, 0x55] {
                let mut bytes = [fill; 14];
                if fill == 0x55 {
                    // xorshift64 of Marsaglia.
                    noise ^= noise << 13;
                    noise ^= noise >> 7;
                    noise ^= noise << 17;
                    bytes[2..10].copy_from_slice(&noise.to_be_bytes());
                }
                bytes[0] = first;
                bytes[4] = fifth;
                let length = if Df::of_first_byte(first).is_long() {
                    14
                } else {
                    7
                };
                let parity = crc24::remainder(&bytes[..length - 3]).to_be_bytes();
                bytes[length - 3..length].copy_from_slice(&parity[1..]);
                seen.extend(
                    fields_of(&bytes[..length])
                        .into_iter()
                        .map(|(name, _)| name),
                );
            }
        }
    }
    // Registers whose values noise does not have.
    for hex in [
        "A800178D10010080F50000D5893C",
        "A0000638FA81C10000000081A92F",
        "A000029C85E42F313000007047D3",
        "A000139381951536E024D4CCF6B5",
        "A00004128F39F91A7E27C46ADC21",
    ] {
        seen.extend(fields_of(&bytes_of(hex)).into_iter().map(|(name, _)| name));
    }
    let missing: Vec<&String> = seen
        .iter()
        .filter(|name| !names.contains(name.as_str()))
        .collect();
    assert!(missing.is_empty(), "not in the help: {missing:?}");
    assert!(seen.len() > 120, "{}", seen.len());
}
