//! Saves of settings by the shipped image, cut and counted in the twin.

use tests::power_cuts::settings::in_twin::{ask, campaign, in_run, wear};
use twin::board::eeprom::Defect;
use twin::board::gnss;
use twin::board::kind::{ADSBEE_1090, ADSBEE_1090_E, ADSBEE_1090U};
use twin::board::{Board, Setup};
use twin::chip::adc::Steady;
use twin::chip::flash::Flash;
use twin::fault::{Fault, Wire};
use twin::image;

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

/// A board in RUN whose GNSS receiver is heard through noise that leaves no sentence whole.
fn with_noisy_gnss() -> Board {
    let mut flash = Flash::new(2 << 20, *b"SQUITTER");
    image::flash_uf2(&tests::image(), &mut flash).expect("the image is flashed");
    let setup = Setup {
        gnss: Some(gnss::Options::default()),
        ..Setup::default()
    };
    let mut board = Board::new(flash, &setup);
    board
        .carry_out(Fault::UartNoise {
            wire: Wire::Gnss,
            rate: 0.05,
        })
        .expect("it happens");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board.run_ms(2_000).expect("the chip runs");
    board
}

/// `AT+TEST` fails with this part alone (and the noisy GNSS), whose line begins so.
fn fails_with(board: &mut Board, line: &str) {
    let said = ask(board, "AT+TEST", 300);
    let failed: Vec<&str> = said
        .lines()
        .filter(|line| line.contains(" FAIL "))
        .collect();
    assert!(failed[0].starts_with(line), "{line}: {said}");
    let name = line.split(' ').next().unwrap_or("");
    assert!(said.ends_with(&format!("\r\nERROR {name}\r\n")), "{said}");
}

#[test]
fn the_self_test_names_the_part_that_fails_first_and_tells_what_it_found() {
    let mut board = with_noisy_gnss();
    fails_with(&mut board, "GNSS FAIL 0 sentences, ");

    let broken = |wreck: &dyn Fn(&mut Board), line: &str| {
        let mut board = board.fork().expect("nothing plays");
        wreck(&mut board);
        fails_with(&mut board, line);
        // In CONFIGURATION its name alone.
        let said = ask(&mut board, "AT+CONFIG=1", 100);
        assert!(said.ends_with("AT+CONFIG_START\r\n"), "{said}");
        let name = line.split(' ').next().unwrap_or("");
        let said = ask(&mut board, "AT+TEST", 300);
        assert_eq!(said, format!("AT+ERROR ({name})\r\n"));
    };
    let adc = |channel: usize, volts: f64| {
        move |board: &mut Board| {
            let bus = &mut board.chip.bus;
            if bus.rssi_adc == Some(channel) {
                bus.rssi_adc = None;
            }
            bus.adc.set_input(channel, Box::new(Steady(volts)));
        }
    };
    let (rssi, level) = (ADSBEE_1090.rssi_adc, ADSBEE_1090.trigger_levels[0].adc);
    // Open and shorted inputs, and a level that stands somewhere else.
    broken(&adc(rssi, 0.0), "RSSI FAIL ");
    broken(&adc(rssi, 3.3), "RSSI FAIL ");
    broken(&adc(level, 0.0), "TRIGGER_LEVEL FAIL ");
    broken(&adc(level, 1.36), "TRIGGER_LEVEL FAIL 1");
    let absent = |board: &mut Board| {
        board
            .carry_out(Fault::Eeprom(Defect::Absent))
            .expect("it happens");
    };
    broken(&absent, "EEPROM FAIL EEPROM does not answer");
}

#[test]
fn the_self_test_of_revision_e_names_a_bus_that_is_held_and_a_low_level_that_is_off() {
    let mut board = in_run(ADSBEE_1090_E);
    let mut other = board.fork().expect("nothing plays");
    let held = Fault::HoldI2c {
        sda: true,
        scl: false,
    };
    board.carry_out(held).expect("it happens");
    let said = ask(&mut board, "AT+TEST", 400);
    for line in [
        "EEPROM FAIL I2C bus is held",
        "SETTINGS FAIL I2C bus is held",
        "RX_GAIN FAIL potentiometer does not answer",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    assert!(said.ends_with("ERROR EEPROM\r\n"), "{said}");

    let low = ADSBEE_1090_E.trigger_levels[1].adc;
    let bus = &mut other.chip.bus;
    bus.adc.set_input(low, Box::new(Steady(0.9)));
    let said = ask(&mut other, "AT+TEST", 300);
    assert!(
        said.contains("TRIGGER_LEVEL_LOW FAIL 899 mV, set 1300 mV"),
        "{said}"
    );
    assert!(said.ends_with("ERROR TRIGGER_LEVEL_LOW\r\n"), "{said}");
}
