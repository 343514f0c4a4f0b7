//! Recordings of radio: complex samples or magnitudes, at any rate from 1 to 64 Msps.
//!
//! | format | a sample |
//! |---|---|
//! | `cu8` | unsigned 8-bit I, Q; 127.5 is zero |
//! | `cs16` | signed 16-bit little-endian I, Q |
//! | `cs16-qi` | the same, Q first. The level is the same; only the name differs |
//! | `mag-u16` | unsigned 16-bit little-endian magnitude |
//!
//! Time 0 of the playback is the start of the pre-roll; the first sample stands at `PRE_ROLL_PS`.

use super::error::Error;
use super::interpolator::Interpolator;
use super::noise::Noise;
use super::{POST_ROLL_PS, PRE_ROLL_PS};
use crate::front_end::parameters::{NOISE_BANDWIDTH_MHZ, RECORDING_FULL_SCALE_DBM};
use crate::front_end::{Level, decibel};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Rate at which the front end works on a recording, Hz: a step is 31 250 ps.
pub const INTERNAL_HZ: u64 = 32_000_000;
/// Picoseconds a step.
const STEP_PS: u64 = 1_000_000_000_000 / INTERNAL_HZ;
/// Rates that make sense, Hz.
const RATES_HZ: std::ops::RangeInclusive<u64> = 1_000_000..=64_000_000;
/// Bytes that are read at a time.
const CHUNK: usize = 1 << 16;
/// The noise of the pre-roll has the power that the quietest samples of the first chunk point to: of exponentially distributed powers a
/// share of 0.3 lies below 0.357 of the mean.
const QUIET_SHARE: f32 = 0.3;
const QUIET_OF_MEAN: f32 = 0.356_67;

/// How a recording's samples are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Cu8,
    Cs16,
    Cs16Qi,
    MagU16,
}

impl Format {
    /// Bytes of one sample.
    pub const fn bytes_a_sample(self) -> usize {
        match self {
            Format::Cu8 | Format::MagU16 => 2,
            Format::Cs16 | Format::Cs16Qi => 4,
        }
    }

    /// I and Q of one sample, full scale 1.
    #[inline(always)]
    pub fn sample(self, bytes: &[u8]) -> (f32, f32) {
        let signed =
            |at: usize| f32::from(i16::from_le_bytes([bytes[at], bytes[at + 1]])) / 32_768.0;
        match self {
            Format::Cu8 => (
                (f32::from(bytes[0]) - 127.5) / 127.5,
                (f32::from(bytes[1]) - 127.5) / 127.5,
            ),
            Format::Cs16 => (signed(0), signed(2)),
            Format::Cs16Qi => (signed(2), signed(0)),
            Format::MagU16 => (
                f32::from(u16::from_le_bytes([bytes[0], bytes[1]])) / 65_535.0,
                0.0,
            ),
        }
    }
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "cu8" => Ok(Format::Cu8),
            "cs16" => Ok(Format::Cs16),
            "cs16-qi" => Ok(Format::Cs16Qi),
            "mag-u16" => Ok(Format::MagU16),
            _ => Err(Error::UnknownFormat {
                name: name.to_owned(),
            }),
        }
    }
}

/// How a recording is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordingOptions {
    pub format: Format,
    /// Samples a second.
    pub rate_hz: u64,
    /// Full scale at the antenna, dBm.
    pub full_scale_dbm: f32,
    /// Seed of the noise before and after.
    pub seed: u64,
}

impl RecordingOptions {
    /// The usual full scale and seed.
    pub fn new(format: Format, rate_hz: u64) -> Self {
        Self {
            format,
            rate_hz,
            full_scale_dbm: RECORDING_FULL_SCALE_DBM,
            seed: 1,
        }
    }
}

/// A recording as received level.
pub struct Recording {
    samples: Samples,
    interpolator: Interpolator,
    full_scale_dbm: f32,
    noise: Noise,
    noise_dbm: f32,
    pre_roll_steps: u64,
    post_roll_steps: u64,
    signal_steps: u64,
}

/// The file, a chunk at a time.
struct Samples {
    path: PathBuf,
    file: File,
    format: Format,
    chunk: Vec<u8>,
    at: usize,
    /// The first error while reading; the recording ends there.
    failed: Option<std::io::Error>,
}

impl Recording {
    /// Opens a recording and looks at its first samples.
    pub fn open(path: &Path, options: &RecordingOptions) -> Result<Self, Error> {
        if !RATES_HZ.contains(&options.rate_hz) {
            return Err(Error::Rate {
                hz: options.rate_hz,
            });
        }
        let unreadable = |cause| Error::Unreadable {
            path: path.to_owned(),
            cause,
        };
        let file = File::open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(unreadable(std::io::Error::other("it is not a file")));
        }
        let bytes = metadata.len();
        let bytes_a_sample = options.format.bytes_a_sample() as u64;
        if bytes == 0 {
            return Err(Error::Empty {
                path: path.to_owned(),
            });
        }
        if bytes % bytes_a_sample != 0 {
            return Err(Error::Truncated {
                path: path.to_owned(),
                bytes,
                bytes_a_sample,
            });
        }
        let mut samples = Samples {
            path: path.to_owned(),
            file,
            format: options.format,
            chunk: Vec::new(),
            at: 0,
            failed: None,
        };
        samples.refill();
        if let Some(cause) = samples.failed {
            return Err(unreadable(cause));
        }
        let noise_dbm = decibel::from_power(samples.noise_power()) + options.full_scale_dbm;
        // The interpolator's output lags by half its window: the pre-roll is shortened by it, the tail of the signal read out.
        let lag = Interpolator::LAG * INTERNAL_HZ / options.rate_hz;
        let length = u128::from(bytes / bytes_a_sample) * u128::from(INTERNAL_HZ)
            / u128::from(options.rate_hz);
        Ok(Self {
            samples,
            interpolator: Interpolator::new(options.rate_hz, INTERNAL_HZ),
            full_scale_dbm: options.full_scale_dbm,
            noise: Noise::new(
                options.seed,
                INTERNAL_HZ as f64,
                f64::from(NOISE_BANDWIDTH_MHZ) * 1e6,
            ),
            noise_dbm,
            pre_roll_steps: PRE_ROLL_PS / STEP_PS - lag,
            signal_steps: length as u64 + lag,
            post_roll_steps: POST_ROLL_PS / STEP_PS,
        })
    }

    /// Noise before and after, dBm at the antenna.
    pub fn noise_dbm(&self) -> f32 {
        self.noise_dbm
    }

    /// The error that ended the playback early, if one did.
    pub fn failure(&mut self) -> Option<Error> {
        self.samples.failed.take().map(|cause| Error::Unreadable {
            path: self.samples.path.clone(),
            cause,
        })
    }
}

impl Samples {
    fn refill(&mut self) {
        self.at = 0;
        self.chunk.resize(CHUNK, 0);
        let mut filled = 0;
        while filled < CHUNK {
            match self.file.read(&mut self.chunk[filled..]) {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(cause) if cause.kind() == std::io::ErrorKind::Interrupted => {}
                Err(cause) => {
                    self.failed = Some(cause);
                    break;
                }
            }
        }
        let size = self.format.bytes_a_sample();
        self.chunk.truncate(filled / size * size);
    }

    fn noise_power(&self) -> f32 {
        let mut powers: Vec<f32> = self
            .chunk
            .chunks_exact(self.format.bytes_a_sample())
            .map(|bytes| {
                let (i, q) = self.format.sample(bytes);
                i * i + q * q
            })
            .collect();
        powers.sort_by(f32::total_cmp);
        let index = (powers.len() as f32 * QUIET_SHARE) as usize;
        powers.get(index).copied().unwrap_or(0.0).max(1e-9) / QUIET_OF_MEAN
    }

    #[inline]
    fn next(&mut self) -> (f32, f32) {
        if self.at >= self.chunk.len() {
            self.refill();
        }
        let size = self.format.bytes_a_sample();
        match self.chunk.get(self.at..self.at + size) {
            Some(bytes) => {
                self.at += size;
                self.format.sample(bytes)
            }
            None => (0.0, 0.0),
        }
    }
}

impl Level for Recording {
    fn step_ps(&self) -> u64 {
        STEP_PS
    }

    fn fill(&mut self, dbm: &mut [f32]) -> usize {
        let mut filled = 0;
        let quiet = (self.pre_roll_steps as usize).min(dbm.len());
        self.noise.fill_level(self.noise_dbm, &mut dbm[..quiet]);
        self.pre_roll_steps -= quiet as u64;
        filled += quiet;
        let loud = (self.signal_steps as usize).min(dbm.len() - filled);
        for level in &mut dbm[filled..filled + loud] {
            let (i, q) = self.interpolator.next(|| self.samples.next());
            *level = decibel::from_power(i * i + q * q) + self.full_scale_dbm;
        }
        self.signal_steps -= loud as u64;
        filled += loud;
        let quiet = (self.post_roll_steps as usize).min(dbm.len() - filled);
        self.noise
            .fill_level(self.noise_dbm, &mut dbm[filled..filled + quiet]);
        self.post_roll_steps -= quiet as u64;
        filled + quiet
    }
}
