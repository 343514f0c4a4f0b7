//! Saves of settings by the shipped image, cut and counted in the twin.

use tests::power_cuts::settings::in_twin::{ask, campaign, in_run, wear};
use twin::board::kind::{ADSBEE_1090, ADSBEE_1090_E, ADSBEE_1090U};

/// Shares of an operation's time at which the supply fails.
const SHARES: [f64; 4] = [0.0, 0.3, 0.7, 1.0];

#[test]
fn no_cut_of_a_save_loses_or_mixes_settings_on_eeprom_and_flash() {
    for kind in [ADSBEE_1090, ADSBEE_1090U] {
        let found = campaign(kind, &SHARES, 24);
        println!("{}: {} cuts, {} new", kind.name, found.cuts, found.new);
        assert_eq!(found.examples, Vec::<String>::new());
        assert!(found.cuts >= 20, "{}", found.cuts);
        assert!(found.new > 0 && found.new < found.cuts, "{}", found.new);
    }
}

#[test]
fn saves_wear_every_page_alike() {
    let saves = 13;
    let (least, most) = wear(ADSBEE_1090, saves);
    // Four banks in turn: the first has been written once more than the others.
    assert_eq!((least, most), (saves / 4, saves / 4 + 1));
}

#[test]
fn the_self_test_passes_on_a_board_that_works_and_writes_its_page_once() {
    for kind in [ADSBEE_1090, ADSBEE_1090U, ADSBEE_1090_E] {
        let mut board = in_run(kind);
        let last_page = twin::board::eeprom::BYTES / twin::board::eeprom::PAGE - 1;
        for n in 0..3 {
            let said = ask(&mut board, "AT+TEST", 200);
            let lines: Vec<&str> = said.lines().collect();
            assert_eq!(lines.last(), Some(&"OK"), "{}: {said}", kind.name);
            assert!(!said.contains("FAIL"), "{}: {said}", kind.name);
            let has = |name: &str| {
                lines
                    .iter()
                    .any(|l| l.starts_with(&format!("{name} PASS ")))
            };
            for name in [
                "FLASH",
                "SETTINGS",
                "RSSI",
                "TRIGGER_LEVEL",
                "CAPTURE",
                "CLOCK_SYS",
                "CLOCK_USB",
            ] {
                assert!(has(name), "{}: no {name} in {said}", kind.name);
            }
            assert_eq!(has("EEPROM"), kind.i2c.is_some(), "{said}");
            assert_eq!(has("RX_GAIN"), kind.name == "adsbee_1090_e", "{said}");
            let is_e = kind.name == "adsbee_1090_e";
            assert_eq!(has("TRIGGER_LEVEL_LOW"), is_e, "{said}");
            assert_eq!(has("GNSS"), kind.gnss.is_some(), "{said}");
            if let Some(eeprom) = board.eeprom() {
                assert_eq!(eeprom.wear(last_page), 1, "test {n}");
            }
        }
    }
}
