//! A scene as a recording of I and Q, for other decoders, and its truth as CSV.
//!
//! ```text
//!   wave at 32 MHz ─ low-pass for the wanted rate ─ every n-th ─ scaled to full scale ─ cu8 or cs16
//! ```
//! The low-pass is a windowed sinc, nine tenths of the rate wide: at 2.4 Msps a decoder sees 2.16 MHz of noise, as from a receiver of that rate. The
//! recording starts with the playback's noise before (5 ms) and ends with that behind. Times in the truth count from its first sample.

use super::{Emission, Scene, path, wave};
use crate::front_end::decibel;
use crate::source::noise::tap;
use crate::source::{Error, Format};
use std::io::{self, Write};

/// Rates that are written, Hz: below, a bit has no two samples; above, there is nothing more than the wave itself.
pub const RATES_HZ: std::ops::RangeInclusive<u64> = 2_000_000..=32_000_000;
/// Half the low-pass, in samples of the recording.
const HALF_SAMPLES: f64 = 10.0;
/// Width of the low-pass in shares of the rate.
const PASS: f64 = 0.9;
/// Places between two samples of the wave at which the low-pass is tabled: 2.4 and all binary parts of 32 MHz fall on one.
const PLACES: u64 = 768;
/// Samples of the wave worked on at a time.
const BLOCK: usize = 4096;
/// Room over the strongest transmission, dB.
const HEADROOM_DB: f32 = 3.0;
/// Full scale is at most so far above the noise in 2 MHz, dB, so that eight bits still show it; what is stronger is clipped, as in a receiver
/// with that gain.
const MOST_OVER_NOISE_DB: f32 = 38.0;

/// How a recording is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// `cu8` or `cs16`.
    pub format: Format,
    pub rate_hz: u64,
    /// Level of full scale at the antenna, dBm; chosen from the scene where `None`.
    pub full_scale_dbm: Option<f32>,
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    pub samples: u64,
    pub full_scale_dbm: f32,
    /// Samples beyond full scale.
    pub clipped: u64,
}

/// Why a scene was not written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    #[error(transparent)]
    Source(#[from] Error),
    #[error("cannot write: {0}")]
    Output(#[from] io::Error),
    #[error("a scene is written as cu8 or cs16, not as {0:?}")]
    Format(Format),
}

/// The full scale that suits a scene, dBm.
pub fn full_scale_dbm(scene: &Scene) -> f32 {
    let levels = scene.emissions.iter().map(|emission| emission.dbm);
    let strongest = levels.fold(f32::NEG_INFINITY, f32::max) + HEADROOM_DB;
    match scene.noise_dbm {
        Some(noise) => {
            let most = noise - path::snr_bandwidth_db() + MOST_OVER_NOISE_DB;
            strongest.min(most).max(most - MOST_OVER_NOISE_DB / 2.0)
        }
        None => strongest,
    }
}

/// Writes the scene's I and Q.
pub fn write(
    scene: &Scene,
    options: &Options,
    out: &mut impl Write,
) -> Result<Written, RecordError> {
    if !RATES_HZ.contains(&options.rate_hz) {
        return Err(Error::RecordRate {
            hz: options.rate_hz,
        }
        .into());
    }
    if !matches!(options.format, Format::Cu8 | Format::Cs16) {
        return Err(RecordError::Format(options.format));
    }
    let full_scale_dbm = options.full_scale_dbm.unwrap_or(full_scale_dbm(scene));
    let scale = 1.0 / decibel::to_amplitude(full_scale_dbm);
    let mut written = Written {
        samples: 0,
        full_scale_dbm,
        clipped: 0,
    };
    let mut decimator = Decimator::new(options.rate_hz);
    let mut wave = scene.wave(wave::STEP_PS);
    let mut bytes = Vec::new();
    loop {
        let mut block = [(0.0, 0.0); BLOCK];
        let count = wave.add(&mut block);
        bytes.clear();
        decimator.feed(&block[..count], &mut |(i, q)| {
            let (i, q) = (i * scale, q * scale);
            written.samples += 1;
            written.clipped += u64::from(i.abs().max(q.abs()) > 1.0);
            encode(options.format, i, q, &mut bytes);
        });
        out.write_all(&bytes)?;
        if count < BLOCK {
            break;
        }
    }
    out.flush()?;
    Ok(written)
}

fn encode(format: Format, i: f32, q: f32, bytes: &mut Vec<u8>) {
    if format == Format::Cu8 {
        let byte = |part: f32| (part * 127.5 + 127.5).round().clamp(0.0, 255.0) as u8;
        bytes.extend([byte(i), byte(q)]);
    } else {
        let word = |part: f32| (part * 32_767.0).round().clamp(-32_767.0, 32_767.0) as i16;
        bytes.extend(word(i).to_le_bytes());
        bytes.extend(word(q).to_le_bytes());
    }
}

/// The truth's header line.
pub const TRUTH_HEADER: &str =
    "arrival_s,role,kind,bits,level_dbm,snr_db,transmitter,carrier_hz,clock_ppm,rise_ns,fall_ns";

/// Writes what was sent: a line an emission, the arrival to a picosecond.
pub fn write_truth(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{TRUTH_HEADER}")?;
    for emission in scene.emissions.iter() {
        let ps = emission.arrival_ps();
        let (whole, part) = (ps / 1_000_000_000_000, ps % 1_000_000_000_000);
        let snr = scene.noise_dbm.map(|noise| emission.snr_db(noise));
        let snr = snr.map_or(String::new(), |snr| format!("{snr:.2}"));
        let sender = scene.fleet.get(emission.transmitter);
        writeln!(
            out,
            "{whole}.{part:012},{},{},{:.2},{snr},{},{:.0},{:.2},{:.1},{:.1}",
            emission.role.name(),
            content(emission),
            emission.dbm,
            emission.transmitter,
            sender.carrier_hz,
            sender.clock_ppm,
            sender.rise_ns,
            sender.fall_ns,
        )?;
    }
    out.flush()
}

/// Kind and bits: hexadecimal for a frame, four octal digits for a reply.
fn content(emission: &Emission) -> String {
    match emission.content {
        super::Content::ModeS(frame) => {
            let hex = frame.bytes().iter().map(|byte| format!("{byte:02x}"));
            format!("mode_s,{}", hex.collect::<String>())
        }
        super::Content::ModeAc { code, spi: false } => format!("mode_ac,{code:04o}"),
        super::Content::ModeAc { code, spi: true } => format!("mode_ac_spi,{code:04o}"),
    }
}

/// From the wave's rate to a recording's.
struct Decimator {
    /// The low-pass at each place between two samples.
    tables: Vec<Vec<f32>>,
    rate_hz: u64,
    recent: Vec<(f32, f32)>,
    /// Number of the wave's sample that `recent` starts with.
    first: u64,
    /// Number of the recording's next sample.
    next: u64,
    half: usize,
}

/// The wave's rate, Hz.
const WAVE_HZ: u64 = 1_000_000_000_000 / wave::STEP_PS;

impl Decimator {
    fn new(rate_hz: u64) -> Self {
        let ratio = WAVE_HZ as f64 / rate_hz as f64;
        let half = (HALF_SAMPLES * ratio).ceil() as usize;
        let tables = (0..PLACES)
            .map(|place| {
                let past = place as f64 / PLACES as f64;
                let taps: Vec<f64> = (0..2 * half)
                    .map(|k| {
                        let x = k as f64 - (half as f64 - 1.0) - past;
                        tap(x, PASS / ratio, half as f64)
                    })
                    .collect();
                let sum: f64 = taps.iter().sum();
                taps.iter().map(|tap| (tap / sum) as f32).collect()
            })
            .collect();
        Self {
            tables,
            rate_hz,
            // What is before the first sample is silence.
            recent: vec![(0.0, 0.0); half],
            first: 0,
            next: 0,
            half,
        }
    }

    /// Takes samples of the wave and gives those of the recording that they complete.
    fn feed(&mut self, samples: &[(f32, f32)], out: &mut impl FnMut((f32, f32))) {
        self.recent.extend_from_slice(samples);
        loop {
            let ahead = self.next * WAVE_HZ;
            let (whole, part) = (ahead / self.rate_hz, ahead % self.rate_hz);
            let place = (part * PLACES + self.rate_hz / 2) / self.rate_hz;
            let (whole, place) = (whole + place / PLACES, place % PLACES);
            // `recent[0]` is the sample `half` before number `first`.
            let from = (whole - self.first) as usize + 1;
            let Some(window) = self.recent.get(from..from + 2 * self.half) else {
                let done = (from - 1).min(self.recent.len());
                self.recent.drain(..done);
                self.first += done as u64;
                return;
            };
            let mut sum = (0.0, 0.0);
            for ((i, q), tap) in window.iter().zip(&self.tables[place as usize]) {
                sum.0 += i * tap;
                sum.1 += q * tap;
            }
            out(sum);
            self.next += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::scene::traffic::{Range, Traffic};

    #[test]
    fn a_recording_shows_each_frame_at_its_time_and_level() {
        let traffic = Traffic {
            frames: 3,
            noise: false,
            snr_db: Range::at(30.0),
            ..Traffic::default()
        };
        let scene = traffic.scene();
        let options = Options {
            format: Format::Cs16,
            rate_hz: 8_000_000,
            full_scale_dbm: None,
        };
        let mut bytes = Vec::new();
        let written = write(&scene, &options, &mut bytes).unwrap();
        assert_eq!(
            (bytes.len() as u64, written.clipped),
            (4 * written.samples, 0)
        );
        let level = |index: usize| {
            let part =
                |at: usize| f32::from(i16::from_le_bytes([bytes[at], bytes[at + 1]])) / 32_767.0;
            let (i, q) = (part(4 * index), part(4 * index + 2));
            decibel::from_power(i * i + q * q) + written.full_scale_dbm
        };
        for emission in scene.emissions.iter() {
            // The middle of the first pulse, then of the gap behind it.
            let at = (emission.arrival_ps() + 250_000) as usize / 125_000;
            assert!((level(at) - emission.dbm).abs() < 1.0, "{}", level(at));
            assert!(level(at + 4) < emission.dbm - 15.0, "{}", level(at + 4));
        }
    }

    #[test]
    fn noise_has_the_power_that_the_rate_lets_through() {
        let traffic = Traffic {
            frames: 0,
            jitter_ps: 20_000_000_000,
            ..Traffic::default()
        };
        let options = Options {
            format: Format::Cs16,
            rate_hz: 2_400_000,
            full_scale_dbm: Some(-90.0),
        };
        let mut bytes = Vec::new();
        write(&traffic.scene(), &options, &mut bytes).unwrap();
        let parts = bytes.chunks_exact(2).map(|part| {
            let value = f32::from(i16::from_le_bytes([part[0], part[1]])) / 32_767.0;
            value * value
        });
        let power = parts.sum::<f32>() / (bytes.len() / 4) as f32;
        let dbm = decibel::from_power(power) - 90.0;
        // -102 dBm in 8 MHz are -107.7 in 2.16.
        assert!((dbm + 107.7).abs() < 0.5, "{dbm}");
    }

    #[test]
    fn rates_and_formats_that_cannot_be_written_are_refused() {
        let scene = Traffic::default().scene();
        let refused = |format, rate_hz| {
            let options = Options {
                format,
                rate_hz,
                full_scale_dbm: None,
            };
            write(&scene, &options, &mut Vec::new())
                .unwrap_err()
                .to_string()
        };
        assert!(refused(Format::Cu8, 1_000_000).contains("1000000 Hz"));
        assert!(refused(Format::MagU16, 2_400_000).contains("cu8 or cs16"));
    }
}
