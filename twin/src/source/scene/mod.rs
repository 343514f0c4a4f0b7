//! Simulated air: transmitters with the tolerances of Annex 10, each transmission at a known time and level, over one path with noise.
//!
//! ```text
//!   traffic ─ emissions ─┬─ truth (bits, arrival, level)
//!                        └─ pulses ─ carrier ─┐
//!                                     noise ──┴─ path ─ wave ─┬─ dBm ─ front end     (native and twin engine)
//!                                                             └─ I and Q ─ recording (peers)
//! ```
//! | file | what |
//! |---|---|
//! | `transmitter` | what of its pulses is a transponder's own |
//! | `pulses` | the pulses of a Mode S frame or a Mode A/C reply |
//! | `path` | the filter before the detector, for signals and noise |
//! | `wave` | all of it added up, sample by sample |
//! | `traffic` | who sends what and when: seeded |
//! | `aircraft` | aircraft that fly and squitter |
//! | `record` | a scene as a recording, and its truth as CSV |
//!
//! Everything follows from the seed. What is left out: multipath, antenna patterns, Doppler, other signals on 1090 MHz than these two. A record of the
//! assumptions is `docs/adr/0009-scene-generator.md`.

pub mod aircraft;
pub mod path;
pub mod pulses;
pub mod record;
pub mod traffic;
pub mod transmitter;
pub mod wave;

use crate::front_end::parameters::NOISE_DBM;
use crate::source::PRE_ROLL_PS;
use mode_s::Frame;
use std::sync::Arc;
pub use transmitter::{Fleet, Tolerances, Transmitter};
pub use wave::Wave;

/// What is transmitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    ModeS(Frame),
    /// A reply to interrogations of Mode A or C: twelve code bits as four octal digits, and the identification pulse.
    ModeAc {
        code: u16,
        spi: bool,
    },
}

/// A transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Leading edge of the first pulse at the receiver, ps after the pre-roll.
    pub at_ps: u64,
    /// Who sends, by number in the fleet.
    pub transmitter: usize,
    /// Power of a pulse at the antenna, dBm.
    pub dbm: f32,
    pub content: Content,
    pub role: Role,
}

/// What a transmission is in the scene for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Counted.
    Wanted,
    /// A frame over a wanted one, counted apart.
    Overlapping,
    /// Not counted.
    Disturbing,
}

impl Role {
    /// As the truth's CSV spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Role::Wanted => "wanted",
            Role::Overlapping => "overlapping",
            Role::Disturbing => "disturbing",
        }
    }
}

impl Emission {
    /// Leading edge of the first pulse from the start of playback, ps.
    pub fn arrival_ps(&self) -> u64 {
        PRE_ROLL_PS + self.at_ps
    }

    /// The frame, if it is one.
    pub fn frame(&self) -> Option<&Frame> {
        match &self.content {
            Content::ModeS(frame) => Some(frame),
            Content::ModeAc { .. } => None,
        }
    }

    /// Signal-to-noise ratio in 2 MHz, dB, over noise of this level in the whole path.
    pub fn snr_db(&self, noise_dbm: f32) -> f32 {
        self.dbm - noise_dbm + path::snr_bandwidth_db()
    }
}

/// The level of a signal of this ratio to the noise in 2 MHz, dBm.
pub fn dbm_at_snr(snr_db: f32) -> f32 {
    NOISE_DBM - path::snr_bandwidth_db() + snr_db
}

/// Emissions in order of time, and their senders.
#[derive(Clone)]
pub struct Scene {
    pub fleet: Arc<Fleet>,
    pub emissions: Arc<Vec<Emission>>,
    /// Noise in the whole path at the antenna, dBm; `None` is silence.
    pub noise_dbm: Option<f32>,
    pub seed: u64,
    /// Length without the noise before and after, ps.
    pub length_ps: u64,
}

impl Scene {
    /// The scene as samples `step_ps` apart.
    pub fn wave(&self, step_ps: u64) -> Wave {
        let emissions = Arc::clone(&self.emissions);
        let list = (0..emissions.len()).map(move |index| emissions[index]);
        Wave::new(
            Arc::clone(&self.fleet),
            Box::new(list),
            wave::Options {
                step_ps,
                noise_dbm: self.noise_dbm,
                seed: self.seed,
                length_ps: self.length_ps,
            },
        )
    }

    /// The emissions of this role.
    pub fn of_role(&self, role: Role) -> impl Iterator<Item = &Emission> {
        let emissions = self.emissions.iter();
        emissions.filter(move |emission| emission.role == role)
    }
}
