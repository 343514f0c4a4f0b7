//! Mode A/C replies against a scene's truth.

use demod::{CountersSnapshot, Reply};
use mode_s::ModeACode;
use twin::front_end::{FrontEnd, Player, Slicer};
use twin::native::{self, Options};
use twin::source::scene::traffic::{LONG_FRAME_PS, Range, Traffic};
use twin::source::scene::{Content, Emission, Scene, wave};

use super::native::{FLOOR_OVER_NOISE_DB, Rendered, SLICERS, calibration, trigger_level_mv};
use super::points::MODE_AC_SNR_DB;
use std::fmt::Write;

/// A reply that a receiver gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heard {
    /// F1's first edge in playback time, ps.
    pub at_ps: i64,
    pub code: u16,
    pub spi: bool,
}

/// A reply may be told so much early or late, ps.
const NEAR_PS: i64 = 1_000_000;
/// From F1 to the end of SPI, ps: replies closer than this overlap; and the same for a frame.
const REPLY_PS: u64 = 25_100_000;
/// Ratio to the noise from which on a reply stands clear of it, dB.
const CLEAR_DB: f32 = 12.0;

/// How many of a scene's replies came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    pub sent: usize,
    pub decoded: usize,
    /// Of those clear of the noise.
    pub clear: usize,
    pub clear_decoded: usize,
    /// Of those clear of the noise that no other transmission overlaps.
    pub alone: usize,
    pub alone_decoded: usize,
    /// Replies with another code than was sent at that time.
    pub wrong: usize,
    /// Replies at a time when nobody sent one.
    pub invented: usize,
}

/// Counts.
pub fn score(scene: &Scene, heard: &[Heard]) -> Score {
    let mut score = Score::default();
    let mut is_matched = vec![false; heard.len()];
    let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
    let emissions = &scene.emissions;
    for (index, emission) in emissions.iter().enumerate() {
        let Content::ModeAc { code, spi } = emission.content else {
            continue;
        };
        let at_ps = emission.arrival_ps() as i64;
        let from = heard.partition_point(|one| one.at_ps < at_ps - NEAR_PS);
        let near = heard[from..]
            .iter()
            .take_while(|one| one.at_ps <= at_ps + NEAR_PS);
        let found = near
            .clone()
            .position(|one| one.code == code && one.spi == spi);
        if let Some(found) = found {
            is_matched[from + found] = true;
        }
        let found = usize::from(found.is_some());
        let is_clear = emission.snr_db(noise_dbm) >= CLEAR_DB;
        let before = index.checked_sub(1).map(|index| &emissions[index]);
        let is_alone = |one: &Emission| {
            one.at_ps.abs_diff(emission.at_ps) > LONG_FRAME_PS
                || one.frame().is_none() && one.at_ps.abs_diff(emission.at_ps) > REPLY_PS
        };
        let is_alone = before.is_none_or(is_alone) && emissions.get(index + 1).is_none_or(is_alone);
        score.sent += 1;
        score.decoded += found;
        if is_clear {
            score.clear += 1;
            score.clear_decoded += found;
            if is_alone {
                score.alone += 1;
                score.alone_decoded += found;
            }
        }
    }
    let mut times: Vec<i64> = emissions
        .iter()
        .filter(|one| one.frame().is_none())
        .map(|one| one.arrival_ps() as i64)
        .collect();
    times.sort_unstable();
    for (one, _) in heard
        .iter()
        .zip(&is_matched)
        .filter(|(_, matched)| !**matched)
    {
        let from = times.partition_point(|&at| at < one.at_ps - NEAR_PS);
        if times.get(from).is_some_and(|&at| at <= one.at_ps + NEAR_PS) {
            score.wrong += 1;
        } else {
            score.invented += 1;
        }
    }
    score
}

/// What a slicer at its usual trigger level and the native engine make of it: replies in order of time.
pub fn heard(level: &Rendered, slicer: Slicer, noise_dbm: f32) -> (Vec<Heard>, CountersSnapshot) {
    let mut player = Player::new(level.clone(), &FrontEnd::with_slicer(slicer));
    let options = Options {
        trigger_level_mv: Some(trigger_level_mv(slicer, noise_dbm, FLOOR_OVER_NOISE_DB)),
        calibration: calibration(slicer),
        ..Options::default()
    };
    let mut replies: Vec<Heard> = Vec::new();
    let counters = native::run_with_replies(&mut player, options, &mut |_| {}, &mut |reply| {
        replies.push(of(&reply));
    });
    replies.sort_by_key(|reply| reply.at_ps);
    (replies, counters)
}

fn of(reply: &Reply) -> Heard {
    Heard {
        at_ps: (reply.arrival * 25_000 / 3) as i64,
        code: ModeACode::of_id13(reply.pulses).0,
        spi: reply.spi,
    }
}

/// Length of each air, ps: 200 ms.
const LENGTH_PS: u64 = 200_000_000_000;
/// What the replies are heard in: name, replies a second, their ratio to the noise, frames of Mode S and picoseconds from one to the next.
const AIRS: [(&str, f64, Range, usize, u64); 8] = [
    ("replies 1k 25-45 dB", 1e3, Range::new(25.0, 45.0), 0, 0),
    ("replies 1k", 1e3, MODE_AC_SNR_DB, 0, 0),
    ("replies 10k", 1e4, MODE_AC_SNR_DB, 0, 0),
    ("replies 20k", 2e4, MODE_AC_SNR_DB, 0, 0),
    ("replies 40k", 4e4, MODE_AC_SNR_DB, 0, 0),
    (
        "replies 10k, 1k frames",
        1e4,
        MODE_AC_SNR_DB,
        200,
        1_000_000_000,
    ),
    ("no reply, noise", 0.0, MODE_AC_SNR_DB, 0, 0),
    (
        "no reply, 8k frames",
        0.0,
        MODE_AC_SNR_DB,
        1_600,
        125_000_000,
    ),
];
/// Ratio of those frames, dB: some are not accepted.
const FRAMES_SNR_DB: Range = Range::new(12.0, 30.0);

/// The heading of the rows.
pub fn heading() -> String {
    let mut line = format!("{:<24}", "");
    for (name, _) in SLICERS {
        let _ = write!(
            line,
            "{name:>10}{:>7}{:>7}{:>7}{:>7}",
            "clear", "alone", "wrong/s", "inv/s"
        );
    }
    line
}

/// A row an air: shares decoded of all replies, of those 12 dB or more over the noise, and of those that nothing overlaps; replies told with another code than was
/// sent, and replies told that nobody sent, a second.
pub fn rows() -> impl Iterator<Item = String> {
    AIRS.into_iter()
        .map(|(name, mode_ac_hz, mode_ac_snr_db, frames, spacing_ps)| {
            let scene = Traffic {
                seed: 7700,
                frames,
                spacing_ps,
                jitter_ps: if frames == 0 { LENGTH_PS } else { 1_000_000 },
                snr_db: FRAMES_SNR_DB,
                mode_ac_hz,
                mode_ac_snr_db,
                ..Traffic::default()
            }
            .scene();
            let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
            let level = Rendered::of(&mut scene.wave(wave::STEP_PS));
            let seconds = level.length_ps() as f64 * 1e-12;
            let mut line = format!("{name:<24}");
            for (_, slicer) in SLICERS {
                let score = score(&scene, &heard(&level, slicer, noise_dbm).0);
                let share = |decoded: usize, of: usize| match of {
                    0 => "-".to_string(),
                    _ => format!("{:.3}", decoded as f64 / of as f64),
                };
                let _ = write!(
                    line,
                    "{:>10}{:>7}{:>7}{:>7.0}{:>7.0}",
                    share(score.decoded, score.sent),
                    share(score.clear_decoded, score.clear),
                    share(score.alone_decoded, score.alone),
                    score.wrong as f64 / seconds,
                    score.invented as f64 / seconds
                );
            }
            line
        })
}
