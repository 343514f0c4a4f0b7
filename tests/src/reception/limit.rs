//! The channel at its limit: long frames back to back, of 400 aircraft in turn, clear of the noise, so that what is lost is lost to load.

use std::collections::HashSet;
use std::sync::Arc;

use twin::front_end::parameters::NOISE_DBM;
use twin::source::scene::aircraft::{Aircraft, InTurn};
use twin::source::scene::traffic::LONG_FRAME_PS;
use twin::source::scene::{Fleet, Tolerances, dbm_at_snr, wave};

/// Aircraft in turn; as many as the device tracks.
pub const AIRCRAFT: usize = 400;
/// Signal-to-noise ratios in 2 MHz, dB.
const SNR_DB: (f32, f32) = (30.0, 40.0);
const SEED: u64 = 8333;
const PLACE: (f64, f64) = (52.4, 13.5);
const PS_A_MS: u64 = 1_000_000_000;

/// Frames in so many milliseconds.
pub fn frames_in(ms: u64) -> usize {
    (ms * PS_A_MS / LONG_FRAME_PS) as usize
}

/// The air, and the bits that were sent.
pub fn back_to_back(ms: u64) -> (wave::Wave, HashSet<Vec<u8>>) {
    let dbm = (dbm_at_snr(SNR_DB.0), dbm_at_snr(SNR_DB.1));
    let sent = || {
        let aircraft = Aircraft::fleet(SEED, AIRCRAFT, PLACE, dbm);
        InTurn::new(aircraft, LONG_FRAME_PS).take(frames_in(ms))
    };
    let bytes = sent().filter_map(|emission| emission.frame().map(|f| f.bytes().to_vec()));
    let bytes = bytes.collect();
    let options = wave::Options {
        step_ps: wave::STEP_PS,
        noise_dbm: Some(NOISE_DBM),
        seed: SEED,
        length_ps: ms * PS_A_MS,
    };
    let fleet = Arc::new(Fleet::new(SEED, AIRCRAFT, &Tolerances::NOMINAL));
    (wave::Wave::new(fleet, Box::new(sent()), options), bytes)
}
