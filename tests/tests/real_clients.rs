//! The short form of `cargo xtask bench clients`: every protocol of the shipped image on real traffic, read by the real clients, compared field by field
//! with the tracker's truth.

use tests::live_clients;

/// Time of each protocol, ms: at least one whole second begins in it.
const PART_MS: u64 = 1_200;
/// From one message of the log to the next, microseconds.
const SPACING_US: u64 = 4_000;

#[test]
fn every_client_understands_all_that_the_image_sends() {
    let folder = tests::root().join("target/clients-short");
    live_clients::record(&folder, PART_MS, SPACING_US).expect("the chip runs");
    let missing = live_clients::understand(&folder);
    assert!(missing.is_empty(), "to be installed: {missing:?}");
    assert!(live_clients::judge(&folder, None), "see the table above");
}
