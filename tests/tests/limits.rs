//! Short forms of the long measurements: the channel at its limit, frames out of nothing, the time of arrival.

use tests::reception::arrival::{air, errors, mean, quantile, rms};
use tests::reception::limit::{self, Reports};
use tests::reception::nothing::{KNOWN, Run};
use twin::front_end::Slicer;
use twin::source::scene::Tolerances;
use twin::source::scene::traffic::Range;

/// Air at the channel's limit, ms.
const LIMIT_MS: u64 = 60;
/// Seconds without a frame.
const NOTHING_S: u64 = 3;
/// Frames whose arrival is looked at.
const ARRIVALS: usize = 100;

#[test]
fn frames_back_to_back_are_all_decoded_and_reported() {
    let outcome = limit::run(Reports::Beast, LIMIT_MS, |_| {}, |_| {});
    assert_eq!(outcome.offered, 500);
    assert_eq!(outcome.decoded, 500, "{outcome:?}");
    assert_eq!(outcome.reported, 500, "{outcome:?}");
    let lost = (
        outcome.overruns,
        outcome.queue_dropped,
        outcome.port_dropped,
    );
    assert_eq!(lost, (0, 0, 0), "{outcome:?}");
    // Core 1 has room; what it would give up first is the arrival.
    assert!(outcome.load[1] < 0.75, "{outcome:?}");
}

#[test]
fn noise_and_replies_alone_give_no_frame_with_400_known_addresses() {
    for mode_ac_hz in [0.0, 40_000.0] {
        let run = Run {
            seed: 4096,
            seconds: NOTHING_S,
            slicer: Slicer::RcFollowing,
            mode_ac_hz,
        };
        let outcome = run.play();
        assert!(outcome.known >= KNOWN * 99 / 100, "{outcome:?}");
        assert_eq!(outcome.invented(), 0, "{outcome:?}");
        // The demodulator did look: a deaf one would pass.
        assert!(outcome.counter("candidates") > Some(1000), "{outcome:?}");
        assert!(outcome.expected() < 1.0, "{outcome:?}");
    }
}

/// From the data block, level and all; the least is the rise times that Annex 10 allows.
#[test]
fn arrivals_are_within_nanoseconds_of_the_truth() {
    let (scene, level) = air(3, ARRIVALS, Range::at(30.0), Tolerances::ANNEX_10);
    let errors = errors(&scene, &level, Slicer::RcFollowing);
    assert!(errors.len() >= ARRIVALS * 98 / 100, "{}", errors.len());
    let errors: Vec<f64> = errors.iter().map(|e| e.data_block_ns).collect();
    let delay = mean(&errors);
    let errors: Vec<f64> = errors.iter().map(|error| error - delay).collect();
    assert!(rms(&errors) < 6.0, "{}", rms(&errors));
    assert!(
        quantile(&errors, 0.999) < 25.0,
        "{}",
        quantile(&errors, 0.999)
    );
}
