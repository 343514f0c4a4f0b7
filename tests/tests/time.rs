//! The shipped image with a GNSS receiver: it locks, stamps, holds over and says so.

use tests::reception::arrival::{self, mean, rms};
use tests::timing::device::{Air, DEVIATIONS, Device};
use twin::board::gnss::Options;
use twin::chip::crystal::Deviation;
use twin::fault::Fault;
use twin::front_end::Slicer;
use twin::source::scene::Tolerances;
use twin::source::scene::traffic::{Range, Traffic};

fn traffic(seed: u64, frames: usize) -> Traffic {
    Traffic {
        seed,
        frames,
        spacing_ps: 2_000_000_000,
        jitter_ps: 500_000_000,
        snr_db: Range::at(30.0),
        ..Traffic::default()
    }
}

#[test]
fn it_locks_and_its_stamps_are_utc() {
    let crystal = Deviation {
        offset_ppb: 20_000,
        ..Deviation::default()
    };
    let mut device = Device::start(crystal, Options::default());
    // Power-on, boot and the fix are two to four seconds; four pulses and three names from there.
    device.run_ms(10_000);
    assert_eq!(device.gnss("state").as_deref(), Some("LOCKED"));
    let hz: i64 = device
        .gnss("clock_hz")
        .and_then(|hz| hz.parse().ok())
        .expect("a number");
    assert!((hz - 120_002_400).abs() <= 2, "{hz}");
    let frames = device.play(&traffic(7, 400).scene());
    let errors: Vec<f64> = frames.iter().filter_map(|f| f.error_ns()).collect();
    assert!(errors.len() > 390, "{} of {}", errors.len(), frames.len());
    let delay = mean(&errors);
    let spread: Vec<f64> = errors.iter().map(|e| e - delay).collect();
    println!("delay {delay:.1} ns, rms {:.1} ns", rms(&spread));
    assert!(delay.abs() < 60.0, "{delay}");
    assert!(rms(&spread) < 60.0, "{}", rms(&spread));

    device
        .board
        .carry_out(Fault::Pps(false))
        .expect("it happens");
    device.run_ms(2_600);
    assert_eq!(device.gnss("state").as_deref(), Some("HOLDOVER"));
    device.run_ms(3_000);
    let frames = device.play(&traffic(8, 20).scene());
    assert!(frames.len() > 15 && frames.iter().all(|f| f.ts1s_ns.is_none()));
}

#[test]
fn where_samples_are_lost_frames_get_no_utc_any_more_and_ticks_go_on() {
    let mut device = Device::start(Deviation::default(), Options::default());
    device.run_ms(10_000);
    let air = Air::new(9, 60, 30.0);
    let stamped = |device: &mut Device| {
        let frames = device.play_air(&air);
        assert!(frames.len() > 50, "{} of 60", frames.len());
        frames.iter().filter(|f| f.ts1s_ns.is_some()).count()
    };
    assert!(stamped(&mut device) > 50);

    // The shorter FIFO lasts 15 us.
    device.carry_out(Fault::StarveDma { us: 12 });
    device.run_ms(200);
    assert_eq!(device.gnss("state").as_deref(), Some("LOCKED"));
    assert!(stamped(&mut device) > 50);

    // Each frame of the air would be stamped 48 us early now.
    device.carry_out(Fault::StarveDma { us: 80 });
    assert_eq!(stamped(&mut device), 0);
    let said = device.ask("AT+LOG_LEVEL=INFO");
    assert!(said.contains("OK"), "{said}");
    // Pulses are there and are not believed.
    device.run_ms(6_000);
    assert_eq!(device.gnss("state").as_deref(), Some("COARSE"));
    assert_eq!(device.gnss("utc").map(|utc| utc.len()), Some(12));
    assert_eq!(stamped(&mut device), 0);
}

/// Ninety-nine in a hundred weak frames come where they are said to; none is further off than the least bound of a clock explains.
#[test]
fn weak_frames_say_how_vague_they_are() {
    const LEAST_CLOCK_BOUND_NS: f64 = 100.0;
    let mut all = Vec::new();
    for (number, snr_db) in [(201, 12.0), (202, 13.0), (203, 14.0)] {
        let (scene, level) = arrival::air(number, 1_500, Range::at(snr_db), Tolerances::ANNEX_10);
        all.extend(arrival::errors(&scene, &level, Slicer::RcFollowing));
    }
    let beyond = |spare_ns: f64| {
        let off = |error: &&arrival::Error| {
            error.data_block_ns.abs() > DEVIATIONS * error.stated_ns + spare_ns
        };
        all.iter().filter(off).count()
    };
    let (told, bound) = (beyond(0.0), beyond(LEAST_CLOCK_BOUND_NS));
    println!(
        "{} frames, {told} beyond what they say, {bound} beyond the bound",
        all.len()
    );
    assert!(all.len() > 2_800, "{}", all.len());
    assert!(told * 200 < all.len(), "{told} of {}", all.len());
    assert_eq!(bound, 0);
}
