//! The recordings of `../shared/data`, and the same samples as the peer needs them: 2.4 Msps.

use super::mutability;
use std::io::Write;
use std::path::{Path, PathBuf};
use twin::source::interpolator::Interpolator;
use twin::source::{Format, Recording, RecordingOptions};

/// A recording.
#[derive(Clone, Copy, Debug)]
pub struct Clip {
    pub name: &'static str,
    pub file: &'static str,
    pub format: Format,
    pub rate_hz: u64,
}

/// One strong aircraft.
pub const MODES1: Clip = Clip {
    name: "modes1",
    file: "modes1.bin",
    format: Format::Cu8,
    rate_hz: 2_000_000,
};
/// Dense traffic, 54.6 ms each.
pub const DENSE: [Clip; 2] = [
    Clip {
        name: "rsadsb-1641427457780",
        file: "rsadsb-1641427457780.cs16",
        format: Format::Cs16Qi,
        rate_hz: 2_400_000,
    },
    Clip {
        name: "rsadsb-old-01",
        file: "rsadsb-old-01.iq",
        format: Format::Cu8,
        rate_hz: 2_400_000,
    },
];

/// Silence behind the samples, so that a decoder that works block by block sees the last one, samples.
const PADDING: usize = 400_000;

impl Clip {
    /// Opens it.
    pub fn open(&self) -> Recording {
        let options = RecordingOptions::new(self.format, self.rate_hz);
        match Recording::open(&crate::recording(self.file), &options) {
            Ok(recording) => recording,
            Err(error) => panic!("{error}"),
        }
    }

    /// Writes the same samples for the peer, sixteen bits so that nothing is lost: its rate, nothing else changed. Q before I or I before Q is the
    /// same to it, since it looks at magnitudes.
    pub fn for_peer(&self, folder: &Path) -> std::io::Result<PathBuf> {
        let bytes = std::fs::read(crate::recording(self.file))?;
        let samples: Vec<(f32, f32)> = bytes
            .chunks_exact(self.format.bytes_a_sample())
            .map(|bytes| self.format.sample(bytes))
            .collect();
        let path = folder.join(format!("{}.sc16", self.name));
        let mut out = std::io::BufWriter::new(std::fs::File::create(&path)?);
        let mut write = |(i, q): (f32, f32)| {
            let word = |part: f32| (part * 32_767.0).round().clamp(-32_767.0, 32_767.0) as i16;
            out.write_all(&word(i).to_le_bytes())?;
            out.write_all(&word(q).to_le_bytes())
        };
        let length = samples.len() as u64 * mutability::RATE_HZ / self.rate_hz;
        let mut samples = samples.into_iter();
        if self.rate_hz == mutability::RATE_HZ {
            samples.try_for_each(&mut write)?;
        } else {
            let mut interpolator = Interpolator::new(self.rate_hz, mutability::RATE_HZ);
            for _ in 0..length + Interpolator::LAG * 2 {
                write(interpolator.next(|| samples.next().unwrap_or_default()))?;
            }
        }
        (0..PADDING).try_for_each(|_| write((0.0, 0.0)))?;
        out.flush()?;
        Ok(path)
    }
}
