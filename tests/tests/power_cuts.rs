//! Power cuts on the host: through updates, by the bootloader's own code over a flash that tears; through saves of settings, by the firmware's store over
//! an EEPROM and a flash that tear. In the twin: the shipped images.

use tests::power_cuts::in_twin::{Part, Script as Images};
use tests::power_cuts::settings::{self, Found, keeper::Keeper, memory::Kind};
use tests::power_cuts::{Outcome, Script, log_lengths};

/// Cuts a run of CI makes at least.
const LEAST_CUTS: u64 = 20_000;

#[test]
fn no_cut_bricks_the_device_wherever_the_log_changes_sectors() {
    let script = Script::new();
    let mut all = Outcome::default();
    for records in log_lengths() {
        let seed = records as u64 * 1000;
        all.add(script.campaign(records, seed..seed + 10, false));
    }
    println!("{}", all.result());
    assert_eq!(all.bricked, Vec::<String>::new());
    assert!(all.cuts >= LEAST_CUTS, "{} cuts", all.cuts);
}

#[test]
fn no_second_cut_bricks_the_device() {
    let script = Script::new();
    let outcome = script.campaign(122, 0..1, true);
    println!("{}", outcome.result());
    assert_eq!(outcome.bricked, Vec::<String>::new());
    assert!(outcome.second_cuts > 1000, "{}", outcome.second_cuts);
}

/// Sizes of settings in the short form, a step apart that is no whole number of pages; and the longest.
fn sizes() -> impl Iterator<Item = usize> {
    (0..512).step_by(27).chain([512, settings::keeper::MAX])
}

#[test]
fn no_cut_of_a_save_loses_or_mixes_settings() {
    for kind in Kind::ALL {
        let mut all = Found::default();
        for size in sizes() {
            all.add(settings::campaign(Keeper::Banks, kind, size, 16));
        }
        println!("{}: {} cuts, {} new", kind.name(), all.cuts, all.new);
        assert_eq!(all.examples, Vec::<String>::new());
        assert_eq!(all.second_cuts, all.cuts);
        assert!(all.cuts >= LEAST_CUTS / 2, "{} cuts", all.cuts);
        assert!(all.new > 0 && all.new < all.cuts / 10, "{} new", all.new);
    }
}

/// The shipped images in the twin, a few cuts of each part; the long form is `cargo xtask bench power-cuts --update`.
#[test]
fn no_cut_or_watchdog_reset_bricks_the_shipped_images() {
    let script = Images::new();
    for part in [Part::Update, Part::Trial, Part::Rollback] {
        let outcome = script.campaign(part, 124, 8);
        println!(
            "{part:?}: {} operations, {} power cuts, {} watchdog resets",
            outcome.operations, outcome.power_cuts, outcome.watchdog_resets
        );
        assert_eq!(outcome.bricked, Vec::<String>::new());
        assert_eq!(outcome.power_cuts, 6);
        assert_eq!(outcome.watchdog_resets, 2);
    }
}
