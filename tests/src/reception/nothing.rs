//! Air in which nothing is sent but what makes addresses known: how many frames a receiver invents.
//!
//! ```text
//!   |400 DF11|. . . . noise, or Mode A/C replies . . . .|400 DF11|. . .        the addresses of 400 aircraft stay known
//! ```
//! Known addresses matter because a frame with address parity is believed when any of them fits: 400 of 2^24 remainders instead of one.

use std::collections::HashSet;
use std::iter::Peekable;
use std::sync::Arc;

use demod::CountersSnapshot;
use twin::front_end::parameters::NOISE_DBM;
use twin::front_end::{FrontEnd, Player, Slicer};
use twin::native::{self, Options};
use twin::source::scene::aircraft::address_of;
use twin::source::scene::traffic::{ModeAc, Range, df11};
use twin::source::scene::{Content, Emission, Fleet, Role, Tolerances, dbm_at_snr, wave};

use super::native::{FLOOR_OVER_NOISE_DB, trigger_level_mv};

/// Addresses kept known.
pub const KNOWN: usize = 400;
/// They are heard again this often, ps: within the ten seconds for which most is believed of a level.
const AGAIN_PS: u64 = 8_000_000_000_000;
/// So many times one after the other, all in turn: where replies destroy one, another is heard.
const TIMES: usize = 4;
/// From one of them to the next, ps.
const SPACING_PS: u64 = 100_000_000;
/// Their ratios to the noise, dB, from the weakest on evenly: nearly all shall be heard, and near and far be among them, because a level vouches, too.
const KNOWN_SNR_DB: (f32, f32) = (18.0, 40.0);
/// Distance of the air's samples, ps: 16 MHz, twice the path's bandwidth.
const STEP_PS: u64 = 62_500;
const PS_A_SECOND: u64 = 1_000_000_000_000;
/// Transmitters of the replies.
const FLEET: usize = 64;

/// Remainders of 24 bits.
const REMAINDERS: f64 = 16_777_216.0;

/// One run.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    pub seed: u64,
    pub seconds: u64,
    pub slicer: Slicer,
    /// Replies a second.
    pub mode_ac_hz: f64,
}

/// What a run gave.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    pub seconds: u64,
    /// Known addresses that were heard exactly at least once.
    pub known: usize,
    /// Frames that nobody sent: by their own parity, after repair, by a known address.
    pub exact: Vec<String>,
    pub repaired: Vec<String>,
    pub by_address: Vec<String>,
    /// DF11 of a known address that were sent, with wrong bits behind the address: not out of nothing, but wrong.
    pub damaged: Vec<String>,
    pub counters: Vec<(&'static str, u64)>,
}

impl Outcome {
    /// Adds another run.
    pub fn add(&mut self, other: Outcome) {
        self.seconds += other.seconds;
        self.known = self.known.max(other.known);
        self.exact.extend(other.exact);
        self.repaired.extend(other.repaired);
        self.by_address.extend(other.by_address);
        self.damaged.extend(other.damaged);
        if self.counters.is_empty() {
            self.counters = other.counters;
        } else {
            for (sum, (_, count)) in self.counters.iter_mut().zip(other.counters) {
                sum.1 += count;
            }
        }
    }

    /// All inventions.
    pub fn invented(&self) -> usize {
        self.exact.len() + self.repaired.len() + self.by_address.len()
    }

    /// Frames that chance gives, from the demodulator's counts of parities it tried: each fits once in 2^24, an address parity once for every known
    /// address.
    pub fn expected(&self) -> f64 {
        let count = |name: &str| match self.counter(name) {
            Some(count) => count as f64,
            None => panic!("the demodulator counts no {name}"),
        };
        // A repaired squitter may be of an unknown address; that the others may not makes the measured number smaller.
        let by_parity = count("trials_exact") + count("trials_repair");
        let by_address = count("trials_address") + count("trials_address_repair");
        (by_parity + by_address * self.known as f64) / REMAINDERS
    }

    /// A counter of the demodulator.
    pub fn counter(&self, name: &str) -> Option<u64> {
        let found = self.counters.iter().find(|(counter, _)| *counter == name);
        found.map(|(_, count)| *count)
    }
}

/// Squitters of the known addresses and replies, in order of time, for ever.
struct Quiet {
    known: u64,
    replies: Peekable<ModeAc>,
}

impl Quiet {
    fn next_known(&self) -> Emission {
        let a_round = (KNOWN * TIMES) as u64;
        let (round, place) = (self.known / a_round, self.known % a_round);
        let number = place % KNOWN as u64;
        let (weakest, strongest) = KNOWN_SNR_DB;
        Emission {
            at_ps: round * AGAIN_PS + place * SPACING_PS,
            transmitter: number as usize,
            dbm: dbm_at_snr(weakest + (strongest - weakest) * number as f32 / KNOWN as f32),
            content: Content::ModeS(df11(address_of(number as usize))),
            role: Role::Disturbing,
        }
    }
}

impl Iterator for Quiet {
    type Item = Emission;

    fn next(&mut self) -> Option<Emission> {
        let known = self.next_known();
        if let Some(reply) = self.replies.next_if(|reply| reply.at_ps < known.at_ps) {
            return Some(reply);
        }
        self.known += 1;
        Some(known)
    }
}

impl Run {
    /// Plays it.
    pub fn play(&self) -> Outcome {
        let options = wave::Options {
            step_ps: STEP_PS,
            noise_dbm: Some(NOISE_DBM),
            seed: self.seed,
            length_ps: self.seconds * PS_A_SECOND,
        };
        let quiet = Quiet {
            known: 0,
            replies: ModeAc::new(self.seed, self.mode_ac_hz, Range::new(0.0, 30.0)).peekable(),
        };
        let fleet = Arc::new(Fleet::new(self.seed, FLEET, &Tolerances::ANNEX_10));
        let length_ps = options.length_ps;
        let quiet = quiet.take_while(move |emission| emission.at_ps < length_ps);
        let wave = wave::Wave::new(fleet, Box::new(quiet), options);
        let mut player = Player::new(wave, &FrontEnd::with_slicer(self.slicer));
        let settings = Options {
            trigger_level_mv: Some(trigger_level_mv(
                self.slicer,
                NOISE_DBM,
                FLOOR_OVER_NOISE_DB,
            )),
            ..Options::default()
        };
        let sent: HashSet<Vec<u8>> = (0..KNOWN)
            .map(|number| df11(address_of(number)).bytes().to_vec())
            .collect();
        let mut heard = HashSet::new();
        let mut outcome = Outcome {
            seconds: self.seconds,
            ..Outcome::default()
        };
        let counters: CountersSnapshot = native::run(&mut player, settings, &mut |raw| {
            let bytes = raw.frame.bytes();
            if sent.contains(bytes) {
                heard.insert(bytes.to_vec());
                return;
            }
            let hex = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            let exact = matches!(raw.frame.df().number(), 11 | 17..=19);
            let damaged = sent.iter().any(|known| known[..4] == bytes[..4]);
            match (exact, raw.repaired()) {
                _ if damaged => outcome.damaged.push(hex),
                (true, 0) if raw.frame.residual() == 0 => outcome.exact.push(hex),
                (true, 1..) => outcome.repaired.push(hex),
                _ => outcome.by_address.push(hex),
            }
        });
        outcome.known = heard.len();
        let (stages, trials) = (counters.stages(), counters.trials());
        outcome.counters = stages
            .iter()
            .chain(&trials)
            .map(|(name, count)| (*name, u64::from(*count)))
            .collect();
        outcome
    }
}
