//! The bootloader keeps its times and its stack (`cargo xtask bench boot-timing` prints them).

#[test]
fn every_time_and_the_stack_of_the_bootloader_are_within_their_limits() {
    for row in tests::boot_timing::rows() {
        println!("{row:?}");
        assert!(row.holds(), "{row:?}");
    }
}
