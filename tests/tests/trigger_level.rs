//! `AT+TL_SET=LEARN` on the shipped images: from any start it settles within 10 s at a level that hears nearly as much as the best fixed one, follows 20 dB of noise
//! up and down, and comes back from a stuck comparator and from dead air.
//!
//! ```text
//!   noise and a few frames ── seconds ──▶ half a second of many frames, from the edge of the noise on: device against native engine at fixed levels
//! ```

use std::collections::HashSet;
use std::sync::Arc;

use tests::reception::device::{Device, counter};
use tests::reception::native::{Rendered, raw_frames};
use twin::board::kind::{ADSBEE_1090, ADSBEE_1090_E, ADSBEE_1090U, Kind};
use twin::front_end::detector::millivolt;
use twin::front_end::parameters::NOISE_DBM;
use twin::front_end::{Edge, Player, PulseSource, Slicer};
use twin::source::scene::traffic::{LONG_FRAME_PS, Range, Traffic};
use twin::source::scene::{Emission, Scene};

/// Distance of the air's samples, ps: 16 MHz, twice the path's bandwidth.
const STEP_PS: u64 = 62_500;
/// The change of the noise, dB.
const LOUDER_DB: f32 = 20.0;
/// Of the frames that the best fixed level hears, so many per cent at least.
const LEAST_PERCENT: usize = 90;
/// Fixed levels that are tried: over the noise, dB, and where the threshold rides on the average, mV.
const OVER_NOISE_DB: [f32; 5] = [4.0, 5.0, 6.0, 7.0, 8.0];
const ON_AVERAGE_MV: [f64; 4] = [1285.0, 1292.0, 1300.0, 1310.0];

/// Noise so many dB over the usual, and frames 10 to 30 dB over it.
fn air(noise_db: f32, frames: usize, a_second: u64, seed: u64) -> Scene {
    let spacing_ps = 1_000_000_000_000 / a_second;
    let mut scene = Traffic {
        seed,
        frames,
        spacing_ps,
        jitter_ps: spacing_ps / 2,
        snr_db: Range::new(noise_db + 10.0, noise_db + 30.0),
        ..Traffic::default()
    }
    .scene();
    scene.noise_dbm = Some(NOISE_DBM + noise_db);
    scene
}

/// Half a second of frames that tells how good a level is.
fn judged(noise_db: f32) -> Scene {
    air(noise_db, 500, 1_000, 4)
}

struct Learning {
    device: Device,
    kind: Kind,
}

impl Learning {
    fn start(kind: Kind) -> Self {
        Self {
            device: Device::start_on(kind),
            kind,
        }
    }

    /// Sets a level and lets it be steered from there.
    fn learn_from(&mut self, mv: u16) {
        for line in [format!("AT+TL_SET={mv},{mv}"), "AT+TL_SET=LEARN".to_owned()] {
            let answer = self.device.ask(&line);
            assert!(answer.contains("OK"), "{line}: {answer}");
        }
    }

    /// Noise and a hundred frames a second for so long, then the frames that are judged: what is heard of these, beside what the best fixed level would hear.
    fn settles_within(&mut self, seconds: f32, noise_db: f32) {
        let lead_ps = (f64::from(seconds) * 1e12) as u64;
        let scene = judged(noise_db);
        let mut whole = air(noise_db, (seconds * 100.0) as usize, 100, 3);
        let mut emissions = whole.emissions.to_vec();
        emissions.retain(|emission| emission.at_ps + LONG_FRAME_PS < lead_ps);
        emissions.extend(scene.emissions.iter().map(|emission| Emission {
            at_ps: emission.at_ps + lead_ps,
            ..*emission
        }));
        whole.emissions = Arc::new(emissions);
        whole.length_ps = lead_ps + scene.length_ps;
        let player = Player::new(whole.wave(STEP_PS), &self.kind.front_end);
        let heard = self.device.play(Box::new(player));
        let heard: HashSet<Vec<u8>> = heard.into_iter().map(|frame| frame.bytes).collect();
        let wanted: HashSet<Vec<u8>> = scene
            .emissions
            .iter()
            .filter_map(|emission| Some(emission.frame()?.bytes().to_vec()))
            .collect();
        let rendered = Rendered::of(&mut scene.wave(STEP_PS));
        let slicer = self.kind.front_end.slicer;
        let levels: Vec<f64> = match slicer {
            Slicer::RcFollowing => ON_AVERAGE_MV.to_vec(),
            _ => OVER_NOISE_DB
                .iter()
                .map(|db| f64::from(millivolt(NOISE_DBM + noise_db + db)))
                .collect(),
        };
        let at = |mv: &f64| {
            let (frames, _) = raw_frames(&rendered, slicer, *mv);
            let bytes = frames.iter().map(|raw| raw.frame.bytes().to_vec());
            bytes.collect::<HashSet<_>>().intersection(&wanted).count()
        };
        let fixed: Vec<usize> = levels.iter().map(at).collect();
        let best = fixed.iter().copied().max().unwrap_or(0);
        let heard = heard.intersection(&wanted).count();
        let level_mv = self.device.board.chip.bus.trigger_level_mv(0);
        println!(
            "{}: {heard} frames at {level_mv:.0?} mV, {fixed:?} at {levels:.0?}",
            self.kind.name
        );
        assert!(best > 300, "the scene is no measure: {fixed:?}");
        assert!(
            heard * 100 >= best * LEAST_PERCENT,
            "{} hears {heard} frames, the best fixed level {best}",
            self.kind.name
        );
    }

    /// A comparator that shows nothing but ones, then air without anything.
    fn stick(&mut self) {
        let before = self.steps();
        self.device
            .play(Box::new(StuckHigh::for_ps(600_000_000_000)));
        self.device.run_ms(600);
        assert!(self.steps() > before + 3, "the steering stands still");
    }

    /// Steps of the steering since the start.
    fn steps(&mut self) -> u64 {
        let stats = self.device.stats();
        counter(&stats, "AIR", "learn_steps").unwrap_or_else(|| panic!("no steps in {stats}"))
    }
}

/// The comparator's output stuck high for so long.
struct StuckHigh {
    left: Vec<Edge>,
}

impl StuckHigh {
    fn for_ps(ps: u64) -> Self {
        let edge = |at_ps, level| Edge { at_ps, level };
        Self {
            left: vec![edge(ps, false), edge(0, true)],
        }
    }
}

impl PulseSource for StuckHigh {
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        while let Some(edge) = self.left.pop_if(|edge| edge.at_ps < until_ps) {
            out.push(edge);
        }
    }

    fn finished(&self) -> bool {
        self.left.is_empty()
    }

    fn set_trigger_level_mv(&mut self, _: f64) {}
}

#[test]
fn a_standing_threshold_is_learned_and_follows() {
    let mut board = Learning::start(ADSBEE_1090_E);
    board.learn_from(3300);
    board.settles_within(6.5, 0.0);
    // The low level, 3300 mV as set, went along.
    let bus = &mut board.device.board.chip.bus;
    let levels = [0, 1].map(|net| bus.trigger_level_mv(net).expect("it has two"));
    assert!((levels[0] - levels[1]).abs() < 2.0, "{levels:?}");
    board.settles_within(3.0, LOUDER_DB);
    board.settles_within(4.5, 0.0);
    board.stick();
    board.settles_within(3.0, 0.0);
    board.learn_from(0);
    board.settles_within(3.0, 0.0);
    // The gain is set and read on the bus all the same.
    board.device.ask("AT+PROTOCOL=CONSOLE,NONE");
    for line in ["AT+RX_GAIN=20", "AT+RX_GAIN?"] {
        let answer = board.device.ask(line);
        assert!(answer.contains("+RX_GAIN=20"), "{line}: {answer}");
    }
}

#[test]
fn a_threshold_that_rides_on_the_average_is_learned() {
    let mut board = Learning::start(ADSBEE_1090);
    board.learn_from(3300);
    board.settles_within(3.0, 0.0);
    board.settles_within(0.7, LOUDER_DB);
    board.stick();
    board.learn_from(0);
    board.settles_within(6.0, 0.0);
}

#[test]
fn the_other_board_with_such_a_slicer_learns_too() {
    let mut board = Learning::start(ADSBEE_1090U);
    board.learn_from(1600);
    board.settles_within(2.5, 0.0);
}

/// Where `lo` is below `hi` the level stays at `lo` and above, although the air, dead as it is, asks for less.
#[test]
fn the_lowest_level_is_kept_where_one_is_set() {
    let mut board = Learning::start(ADSBEE_1090);
    for line in ["AT+TL_SET=1330,1400", "AT+TL_SET=LEARN"] {
        let answer = board.device.ask(line);
        assert!(answer.contains("OK"), "{line}: {answer}");
    }
    board.device.run_ms(2_000);
    let level_mv = board.device.board.chip.bus.trigger_level_mv(0);
    let level_mv = level_mv.expect("it has one");
    assert!((level_mv - 1330.0).abs() < 1.0, "{level_mv} mV");
}
