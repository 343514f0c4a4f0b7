//! The bootloader's times and its stack within their limits, all of `cargo xtask bench boot-timing`.

use tests::boot_timing::{ALL, Row};

#[test]
fn every_time_and_the_stack_are_within_their_limits() {
    let outside: Vec<String> = ALL
        .iter()
        .map(|measurement| measurement.row())
        .filter(|row| !row.holds())
        .map(
            |Row {
                 what,
                 measured,
                 unit,
                 limits,
             }| {
                format!(
                    "{what}: {measured:.0} {unit}, not {} to {}",
                    limits.0, limits.1
                )
            },
        )
        .collect();
    assert!(outside.is_empty(), "{outside:#?}");
}
