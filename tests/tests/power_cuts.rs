//! Power cuts through updates, on the host: the bootloader's own code over a flash that tears.

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
