//! The short form of `cargo xtask bench twin-long`: a minute asleep and a minute on the air in two parts.

use tests::long::{OnTheAir, asleep, resident_bytes, sleep};

/// Memory that a minute may leave behind, bytes: what buffers grow to in the first seconds.
const GROWTH: u64 = 64 << 20;

#[test]
fn a_minute_asleep_is_a_minute_to_the_microsecond() {
    let mut board = asleep().expect("the image boots");
    let slept = sleep(&mut board, 60).expect("it sleeps");
    assert_eq!(slept.drift_us, 0);
    assert_eq!(slept.wakes, 61, "one at the start, one a second");
    // Twenty-odd cycles and the APB's waits at each wake-up; core 1 once, to fall asleep. Nothing else costs anything.
    assert!(slept.busy[0] < 61 * 50, "{:?}", slept.busy);
    assert!(slept.busy[1] < 10, "{:?}", slept.busy);
}

#[test]
fn a_minute_on_the_air_in_two_parts_balances() {
    let before = resident_bytes();
    let mut air = OnTheAir::new(&tests::log()).expect("the image boots");
    air.part(30).expect("the first part");
    // The second goes on from what the first left in a file.
    let kept = tests::root().join("target/long-test.device");
    air.keep(&kept).expect("it is kept");
    let first = air.frames;
    let mut air = OnTheAir::go_on(&tests::log(), &kept).expect("it goes on");
    air.part(30).expect("the second part");
    assert_eq!(air.parts, 2);
    assert!(air.frames > first, "{first} and {}", air.frames);
    assert_eq!(air.overruns, 0);
    assert!(air.frames > 100, "{}", air.frames);
    let grown = resident_bytes().saturating_sub(before);
    assert!(grown < GROWTH, "{grown} bytes more");
}
