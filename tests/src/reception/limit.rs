//! The channel at its limit: long frames back to back, of 400 aircraft in turn, clear of the noise, so that what is lost is lost to load.

use std::collections::HashSet;
use std::sync::Arc;

use super::device::{Device, counter};
use twin::front_end::parameters::NOISE_DBM;
use twin::front_end::{FrontEnd, Player};
use twin::source::PRE_ROLL_PS;
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

/// What came of it in the device.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Frames on the air.
    pub offered: usize,
    /// Frames the demodulator accepted.
    pub decoded: u64,
    /// Frames that were sent and came out of the console, as Beast.
    pub reported: usize,
    /// Times the ring was lapped or the FIFO full.
    pub overruns: u64,
    pub queue_dropped: u64,
    pub port_dropped: u64,
    /// Share of the time that each core worked while the frames came.
    pub load: [f64; 2],
    /// Aircraft lines of one second, CONSOLE and COMMS_UART.
    pub lines: [usize; 2],
}

/// Reports of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reports {
    /// Beast on CONSOLE, nothing on COMMS_UART.
    Beast,
    /// CSBee on both, COMMS_UART at 921 600 baud.
    Csbee,
}

impl Reports {
    pub fn name(self) -> &'static str {
        match self {
            Reports::Beast => "beast",
            Reports::Csbee => "csbee",
        }
    }

    /// After the air fell silent: the queue, the ports and, for CSBee, the next second's lines, ms.
    fn tail_ms(self) -> u64 {
        match self {
            Reports::Beast => 100,
            Reports::Csbee => 1_900,
        }
    }

    fn set(self, device: &mut Device) {
        match self {
            Reports::Beast => device.ask("AT+PROTOCOL=COMMS_UART,NONE"),
            Reports::Csbee => {
                device.ask("AT+BAUDRATE=COMMS_UART,921600");
                device.ask("AT+PROTOCOL=COMMS_UART,CSBEE")
            }
        };
    }
}

/// Plays so many milliseconds of it into a device. `loaded` sees the device at the end of the air, `starts` when it begins.
pub fn run(
    reports: Reports,
    ms: u64,
    starts: impl FnOnce(&mut Device),
    loaded: impl FnOnce(&Device),
) -> Outcome {
    let mut device = Device::start();
    reports.set(&mut device);
    let before = device.stats();
    device.ask(&format!(
        "AT+PROTOCOL=CONSOLE,{}",
        reports.name().to_uppercase()
    ));
    let (wave, sent) = back_to_back(ms);
    let playback = device.play_on(Box::new(Player::new(wave, &FrontEnd::ADSBEE_1090)));
    device.run_ms(PRE_ROLL_PS / PS_A_MS);
    device.board.comms_read();
    starts(&mut device);
    let start = (device.board.chip.now(), device.board.chip.busy_cycles());
    let mut heard = device.collect(playback, ms);
    let elapsed = (device.board.chip.now() - start.0) as f64;
    let busy = device.board.chip.busy_cycles();
    loaded(&device);
    heard.extend(device.collect(playback, reports.tail_ms()));
    let said = [device.said.clone(), device.board.comms_read()];
    let after = device.stats();
    let grown = |stage: &str, name: &str| {
        let count = |stats: &str| match counter(stats, stage, name) {
            Some(count) => count,
            None => panic!("no {stage} {name} in {stats}"),
        };
        count(&after) - count(&before)
    };
    Outcome {
        offered: frames_in(ms),
        decoded: grown("QUEUE", "offered"),
        reported: heard
            .iter()
            .filter(|frame| sent.contains(&frame.bytes))
            .count(),
        overruns: grown("DEMOD", "overruns") + grown("CAPTURE", "fifo_overflows"),
        queue_dropped: grown("QUEUE", "dropped"),
        port_dropped: grown("CONSOLE", "dropped") + grown("COMMS_UART", "dropped"),
        load: [0, 1].map(|core| (busy[core] - start.1[core]) as f64 / elapsed),
        lines: said.map(|said| longest_burst(&String::from_utf8_lossy(&said))),
    }
}

/// Most aircraft lines between two `#S` lines.
fn longest_burst(said: &str) -> usize {
    let mut bursts = Vec::new();
    for line in said.lines() {
        if line.starts_with("#S:") {
            bursts.push(0);
        } else if line.starts_with("#A:")
            && let Some(burst) = bursts.last_mut()
        {
            *burst += 1;
        }
    }
    bursts.into_iter().max().unwrap_or(0)
}
