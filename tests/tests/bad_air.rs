//! A comparator that shows nothing sensible: stuck high, stuck low, toggling at 10 MHz, toggling at random like a frame's pulses. The shipped image in the twin stays responsive, counts what it sees,
//! invents nothing, and hears again as soon as the air is good.

use std::collections::HashSet;

use tests::reception::device::{Device, counter};
use twin::front_end::{Edge, FrontEnd, Player, PulseSource};
use twin::source::random::Random;
use twin::source::scene::traffic::{Range, Traffic};
use twin::source::scene::wave;

/// How long the air is bad, ps.
const BAD_PS: u64 = 150_000_000_000;
/// Playback before the comparator goes wrong, ps.
const GOOD_BEFORE_PS: u64 = 1_000_000_000;
/// Half a period of 10 MHz, ps.
const HALF_PERIOD_PS: u64 = 50_000;
/// Half a bit of Mode S, ps.
const HALF_BIT_PS: u64 = 500_000;
/// Words of 32 samples in a millisecond of 8 Msps.
const WORDS_A_MS: u64 = 250;
const PS_A_MS: u64 = 1_000_000_000;

/// A pin that from some time on stays at a level or toggles.
struct Bad {
    next_ps: u64,
    level: bool,
    toggling: Toggling,
    end_ps: u64,
}

/// How the pin goes on after its first edge.
enum Toggling {
    Never,
    /// Every so many picoseconds.
    Every(u64),
    /// After one or two halves of a bit, at random: as much like a frame as anything can be.
    LikeBits(Random),
}

impl Bad {
    fn stuck(level: bool) -> Self {
        Self {
            next_ps: GOOD_BEFORE_PS,
            level,
            toggling: Toggling::Never,
            end_ps: BAD_PS,
        }
    }

    fn toggling(toggling: Toggling) -> Self {
        Self {
            toggling,
            ..Self::stuck(true)
        }
    }

    /// From one edge to the next; beyond the end where there is none.
    fn step_ps(&mut self) -> u64 {
        match &mut self.toggling {
            Toggling::Never => self.end_ps,
            Toggling::Every(ps) => *ps,
            Toggling::LikeBits(random) => HALF_BIT_PS * (1 + random.word() % 2),
        }
    }
}

impl PulseSource for Bad {
    fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        while self.next_ps < until_ps && self.next_ps <= self.end_ps {
            let last = self.next_ps == self.end_ps;
            out.push(Edge {
                at_ps: self.next_ps,
                level: self.level && !last,
            });
            self.level = !self.level;
            let step_ps = self.step_ps();
            self.next_ps = match last {
                true => self.end_ps + 1,
                false => (self.next_ps + step_ps).min(self.end_ps),
            };
        }
    }

    fn finished(&self) -> bool {
        self.next_ps > self.end_ps
    }

    fn set_trigger_level_mv(&mut self, _: f64) {}
}

fn count(stats: &str, stage: &str, name: &str) -> u64 {
    counter(stats, stage, name).unwrap_or_else(|| panic!("no {stage} {name} in {stats}"))
}

/// Plays bad air, asks meanwhile, plays good air; gives the counters before, during and after.
fn survives(bad: Bad) -> [String; 3] {
    let mut device = Device::start();
    let before = device.stats();
    let playback = device.play_on(Box::new(bad));
    let mut heard = device.collect(playback, BAD_PS / PS_A_MS / 2);
    let during = device.stats();
    assert!(during.contains("+STATS=CAPTURE,"), "no answer: {during:?}");
    heard.extend(device.collect(playback, BAD_PS / PS_A_MS / 2));
    assert_eq!(heard, [], "frames out of nothing");

    let scene = Traffic {
        frames: 60,
        snr_db: Range::at(30.0),
        ..Traffic::default()
    }
    .scene();
    let wave = scene.wave(wave::STEP_PS);
    let heard = device.play(Box::new(Player::new(wave, &FrontEnd::ADSBEE_1090)));
    let heard: HashSet<&[u8]> = heard.iter().map(|frame| frame.bytes.as_slice()).collect();
    let frames = scene
        .emissions
        .iter()
        .filter_map(|emission| emission.frame());
    let missed = frames
        .filter(|frame| !heard.contains(frame.bytes()))
        .count();
    assert_eq!(missed, 0, "it does not hear again");
    let after = device.stats();
    assert_eq!(
        device.board.chip.resets.len(),
        2,
        "it restarted: {:?}",
        device.board.chip.resets
    );
    [before, during, after]
}

/// Capture went on: every word was taken, none lost.
fn captured_all([before, _, after]: &[String; 3]) {
    let grown = |stage, name| count(after, stage, name) - count(before, stage, name);
    assert!(grown("CAPTURE", "words") > BAD_PS / PS_A_MS * WORDS_A_MS);
    assert_eq!(grown("DEMOD", "overruns"), 0, "{after}");
    assert_eq!(grown("CAPTURE", "fifo_overflows"), 0, "{after}");
}

/// A pin that does not move looks like no preamble.
fn no_candidates([before, during, _]: &[String; 3]) {
    let [before, during] = [before, during].map(|stats| count(stats, "DEMOD", "candidates"));
    assert_eq!(before, during);
}

#[test]
fn a_comparator_stuck_low_is_silence() {
    let stats = survives(Bad::stuck(false));
    captured_all(&stats);
    no_candidates(&stats);
}

#[test]
fn a_comparator_stuck_high_gives_no_frames_and_no_work() {
    let stats = survives(Bad::stuck(true));
    captured_all(&stats);
    no_candidates(&stats);
}

#[test]
fn a_comparator_toggling_at_10_mhz_is_survived() {
    let stats = survives(Bad::toggling(Toggling::Every(HALF_PERIOD_PS)));
    captured_all(&stats);
}

#[test]
fn pulses_at_random_that_look_like_bits_are_survived_and_counted() {
    let stats = survives(Bad::toggling(Toggling::LikeBits(Random::new(10))));
    let [before, during, after] = &stats;
    // More work than core 1 can do: what it gives up is counted, and little.
    let lost = count(after, "DEMOD", "overrun_words") - count(before, "DEMOD", "overrun_words");
    assert!(lost < BAD_PS / PS_A_MS * WORDS_A_MS / 20, "{after}");
    let tried = count(during, "DEMOD", "candidates") - count(before, "DEMOD", "candidates");
    assert!(tried > 500, "{during}");
}
