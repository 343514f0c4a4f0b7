//! What is stored loads as it was; what is damaged falls back alone.

use super::*;
use crate::choices::{Decoded, LogLevel, Raw};
use crate::kind::Kind;
use proptest::prelude::*;
use std::vec::Vec;

fn bytes(stored: &Stored) -> Vec<u8> {
    let mut out = [0; MAX_BYTES];
    let length = stored.save(&mut out);
    out[..length].to_vec()
}

/// Every field at its highest value.
fn largest() -> Stored {
    let mut stored = Stored::FACTORY;
    for row in ROWS.iter().filter(|row| row.field.is_stored()) {
        let value = match row.kind {
            Kind::Choice(choices) => Value::Number(i32::from(choices[choices.len() - 1].code)),
            Kind::Text { .. } => Value::Text(Text::new("12345678901234567890").unwrap()),
            kind => Value::Number(kind.range().1),
        };
        for port in Port::ALL {
            assert!(row.field.put(&mut stored.settings, port, value));
        }
    }
    stored
}

#[test]
fn the_largest_set_with_all_unknown_keys_fits() {
    let mut stored = largest();
    stored.keep(127, &[7; MAX_UNKNOWN - 2]);
    assert_eq!(stored.refused, 0);
    let bytes = bytes(&stored);
    assert!(bytes.len() < MAX_BYTES, "{}", bytes.len());
    assert_eq!(Stored::load(&bytes), Some(stored));
}

#[test]
fn a_bad_value_falls_back_alone() {
    let mut stored = Stored::FACTORY;
    stored.settings.tl_hi_mv = 2000;
    stored.settings.log_level = LogLevel::Info;
    let mut bytes = bytes(&stored);
    let at = bytes
        .windows(2)
        .position(|w| w == [Field::LogLevel as u8, 1])
        .unwrap();
    bytes[at + 2] = 77;
    let loaded = Stored::load(&bytes).unwrap();
    assert_eq!(loaded.refused, 1);
    assert_eq!(loaded.settings.log_level, Settings::FACTORY.log_level);
    assert_eq!(loaded.settings.tl_hi_mv, 2000);
}

#[test]
fn good_values_that_do_not_go_together_fall_back() {
    let mut stored = Stored::FACTORY;
    stored.settings.console.decoded = Decoded::Gdl90;
    stored.settings.console.raw = Raw::Beast;
    stored.settings.tl_hi_mv = 1400;
    let loaded = Stored::load(&bytes(&stored)).unwrap();
    assert_eq!(loaded.settings.console, Settings::FACTORY.console);
    assert_eq!(loaded.settings.tl_hi_mv, 1400);
}

#[test]
fn unknown_keys_are_stored_again_and_known_ones_of_a_newer_schema_hold() {
    let newer = [2, 120, 3, 1, 2, 3, Field::TlHi as u8, 2, 0x14, 0x05, 190, 0];
    let loaded = Stored::load(&newer).unwrap();
    assert_eq!(loaded.settings.tl_hi_mv, 1300);
    let again = bytes(&loaded);
    assert!(again.ends_with(&[120, 3, 1, 2, 3, 190, 0]));
    assert_eq!(Stored::load(&again), Some(loaded));
}

#[test]
fn what_is_no_set_is_none() {
    assert_eq!(Stored::load(&[]), None);
    assert_eq!(Stored::load(&[0; 40]), None);
    assert_eq!(Stored::load(&[0xff; 40]), None);
    assert_eq!(Stored::load(&[SCHEMA]), Some(Stored::FACTORY));
}

#[test]
fn numbers_are_as_short_as_they_hold() {
    for value in [
        0,
        -1,
        127,
        128,
        -129,
        32_767,
        32_768,
        8_388_608,
        i32::MIN,
        i32::MAX,
    ] {
        let mut out = [0; MAX_BYTES];
        let mut writer = Writer {
            out: &mut out,
            length: 0,
        };
        writer.item(1, Value::Number(value));
        let length = writer.length;
        assert_eq!(number(&out[2..length]), Some(value));
    }
    assert_eq!(number(&[]), None);
    assert_eq!(number(&[0; 5]), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_load_or_not_without_a_panic_and_what_loads_goes_together(
        bytes in prop::collection::vec(prop_oneof![any::<u8>(), 0u8..64, 1u8..5], 0..600),
    ) {
        if let Some(stored) = Stored::load(&bytes) {
            prop_assert_eq!(stored.settings.check(), Ok(()));
            let mut out = [0; MAX_BYTES];
            let length = stored.save(&mut out);
            let again = Stored::load(&out[..length]).unwrap();
            prop_assert_eq!(again.settings, stored.settings);
            prop_assert_eq!(again.unknown, stored.unknown);
        }
    }
}
