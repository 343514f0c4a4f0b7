//! Power cuts through the life of a device: start, update, trial, confirmation, a bad update and its rollback, one more update. The power
//! fails at every flash operation of it, before it and inside it, then comes back; sometimes it fails once more while the device recovers.
//!
//! ```text
//!   factory 1 ─ start, confirm ─ update 2 ─ trial, confirm ─ update 3 (never confirms) ─ 3 trials ─ back to 2 ─ update 4 ─ trial, confirm
//! ```
//! A device counts as bricked when, after the power is back, it runs nothing, or anything but the release that was confirmed last and the one
//! that was being installed, or when the interrupted step, done again, does not lead to the same end.

pub mod device;
pub mod flash;
pub mod in_twin;
pub mod release;
pub mod settings;

use boot_contract::boot_log::{Record, SlotName};
use boot_core::keys::PUBLIC_KEY;

use device::{Device, Running, Stopped};
use flash::Cut;
use release::{Release, public};

/// Bytes of slot A's image: two sectors, the last page not full.
const IMAGE: usize = 6000;
/// Starts of a bad image before it is given up: three tries, then the other one runs.
const BAD_STARTS: usize = 4;

/// Lines in the log when a campaign begins: none, and so many that the move to the other sector falls into each part of the script, which writes
/// sixteen.
pub fn log_lengths() -> impl Iterator<Item = usize> {
    std::iter::once(0).chain(110..127)
}

/// The releases and what happens to them, in order.
pub struct Script {
    keys: [[u8; PUBLIC_KEY]; 1],
    releases: [Release; 4],
    packages: [Vec<u8>; 4],
}

/// A stage of the script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// First start of what was flashed by hand.
    First,
    /// Update to release `to`, which works.
    Good { to: usize },
    /// Update to release `to`, which never confirms.
    Bad { to: usize },
}

/// All of them, with the release that is confirmed when each begins.
const STAGES: [(Stage, usize); 4] = [
    (Stage::First, 0),
    (Stage::Good { to: 1 }, 0),
    (Stage::Bad { to: 2 }, 1),
    (Stage::Good { to: 3 }, 1),
];

/// What a campaign found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Power cuts made, second ones among them.
    pub cuts: u64,
    /// Second cuts, during the recovery from a first one.
    pub second_cuts: u64,
    /// Flash operations of the uncut script, of which each was cut.
    pub operations: u64,
    /// Devices that did not come back as they must, with what was done to them.
    pub bricked: Vec<String>,
}

impl Outcome {
    /// As the benches print it.
    pub fn result(&self) -> String {
        format!("cuts={} bricked={}", self.cuts, self.bricked.len())
    }

    /// Adds another one's figures.
    pub fn add(&mut self, other: Outcome) {
        self.cuts += other.cuts;
        self.second_cuts += other.second_cuts;
        self.operations += other.operations;
        self.bricked.extend(other.bricked);
    }
}

impl Default for Script {
    fn default() -> Self {
        Self::new()
    }
}

impl Script {
    /// Four releases; the last raises the security counter.
    pub fn new() -> Self {
        let releases = [(1, 1), (2, 1), (3, 1), (4, 2)]
            .map(|(version, counter)| Release::new(version, counter, IMAGE, 1));
        Self {
            keys: [public(1)],
            packages: releases.each_ref().map(Release::package),
            releases,
        }
    }

    /// A device as flashed, whose log already has `records` lines, so that it moves to its other sector at another moment.
    fn device(&self, records: usize) -> Device<'_> {
        let mut device = Device::factory(&self.releases[0], &self.keys);
        let mut log = device.log().expect("the power is on");
        for n in 0..records {
            // What older images left behind.
            let record = Record::Rejected {
                slot: SlotName::B,
                image: [n as u8; 8],
            };
            log.append(&mut device.flash, record)
                .expect("the power is on");
        }
        device.flash.operations = 0;
        device
    }

    /// Starts the device; what runs must be exactly one of `may`.
    fn start(&self, device: &mut Device, on: bool, may: &[usize]) -> Result<Running, Failed> {
        let running = device.start(on)?;
        let version = usize::from(running.header.version[0]) - 1;
        if !may.contains(&version) {
            return Err(Failed::Bricked(format!("release {} runs", version + 1)));
        }
        if !device.holds(running.slot, &self.releases[version]) {
            return Err(Failed::Bricked("the image is not the release".into()));
        }
        Ok(running)
    }

    /// One stage from its beginning.
    fn stage(&self, device: &mut Device, stage: Stage, confirmed: usize) -> Result<(), Failed> {
        match stage {
            Stage::First => {
                let running = self.start(device, true, &[confirmed])?;
                device.confirm(running)?;
            }
            Stage::Good { to } => {
                device.update(&self.packages[to])?;
                let running = self.start(device, false, &[to])?;
                device.confirm(running)?;
            }
            Stage::Bad { to } => {
                device.update(&self.packages[to])?;
                for _ in 1..BAD_STARTS {
                    self.start(device, false, &[to])?;
                }
                self.start(device, false, &[confirmed])?;
            }
        }
        Ok(())
    }

    /// The power came back in the middle of a stage: the device must run, and the stage, done again, must succeed.
    fn recover(&self, device: &mut Device, n: usize) -> Result<(), Failed> {
        let (stage, confirmed) = STAGES[n];
        let may = match stage {
            Stage::First => vec![confirmed],
            Stage::Good { to } | Stage::Bad { to } => vec![confirmed, to],
        };
        self.start(device, true, &may)?;
        self.stage(device, stage, confirmed)
    }

    /// Everything after stage `n`.
    fn rest(&self, device: &mut Device, n: usize) -> Result<(), Failed> {
        for (stage, confirmed) in &STAGES[n + 1..] {
            self.stage(device, *stage, *confirmed)?;
        }
        let last = self.releases.len() - 1;
        self.start(device, false, &[last])?;
        let floor = device.log()?.state().floor;
        if floor != 2 {
            return Err(Failed::Bricked(format!("the floor is {floor}")));
        }
        Ok(())
    }

    /// Cuts every operation of the script on a device whose log has `records` lines: once before it, and inside it as each of `seeds` draws.
    /// With `twice`, every operation of the recovery is cut as well.
    pub fn campaign(&self, records: usize, seeds: std::ops::Range<u64>, twice: bool) -> Outcome {
        let mut outcome = Outcome::default();
        let mut device = self.device(records);
        for (n, &(stage, confirmed)) in STAGES.iter().enumerate() {
            let before = device.clone();
            let first = device.flash.operations;
            if let Err(failed) = self.stage(&mut device, stage, confirmed) {
                outcome
                    .bricked
                    .push(format!("{stage:?}, no cut: {failed:?}"));
                return outcome;
            }
            let operations = device.flash.operations - first;
            outcome.operations += operations as u64;
            for after in 0..operations {
                for inside in std::iter::once(None).chain(seeds.clone().map(Some)) {
                    let cut = Cut { after, inside };
                    self.cut(&mut outcome, before.clone(), n, cut, twice);
                }
            }
        }
        if let Err(failed) = self.rest(&mut device, STAGES.len() - 1) {
            outcome
                .bricked
                .push(format!("at the end, no cut: {failed:?}"));
        }
        outcome
    }

    /// One cut in stage `n` of a device that has come so far.
    fn cut(&self, outcome: &mut Outcome, mut device: Device, n: usize, cut: Cut, twice: bool) {
        let (stage, confirmed) = STAGES[n];
        device.flash.cut(Some(cut));
        let told = |failed: &dyn std::fmt::Debug| format!("{stage:?} {cut:?}: {failed:?}");
        match self.stage(&mut device, stage, confirmed) {
            Err(Failed::Stopped(Stopped::PowerLost)) => outcome.cuts += 1,
            other => return outcome.bricked.push(told(&other)),
        }
        device.flash.power_on();
        if twice {
            self.second_cuts(outcome, &device, n, cut);
        }
        // What a torn operation left is gone once the stage has been done again: later stages are run after the cuts before operations only.
        let went = match (self.recover(&mut device, n), cut.inside) {
            (Ok(()), None) => self.rest(&mut device, n),
            (recovered, _) => recovered,
        };
        if let Err(failed) = went {
            outcome.bricked.push(told(&failed));
        }
    }

    /// The power fails again at each operation of the recovery from `first`.
    fn second_cuts(&self, outcome: &mut Outcome, torn: &Device, n: usize, first: Cut) {
        for after in 0.. {
            let second = Cut {
                after,
                inside: first.inside.map(|seed| seed ^ after as u64),
            };
            let mut device = torn.clone();
            device.flash.cut(Some(second));
            match self.recover(&mut device, n) {
                Ok(()) => return,
                Err(Failed::Stopped(Stopped::PowerLost)) => {
                    outcome.cuts += 1;
                    outcome.second_cuts += 1;
                }
                Err(failed) => {
                    let stage = STAGES[n].0;
                    outcome
                        .bricked
                        .push(format!("{stage:?} {first:?} {second:?}: {failed:?}"));
                    return;
                }
            }
            device.flash.power_on();
            if let Err(failed) = self.recover(&mut device, n) {
                let stage = STAGES[n].0;
                outcome
                    .bricked
                    .push(format!("{stage:?} {first:?} {second:?}: {failed:?}"));
            }
        }
    }
}

/// What ended a part of the script early.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Failed {
    Stopped(Stopped),
    Bricked(String),
}

impl From<Stopped> for Failed {
    fn from(stopped: Stopped) -> Self {
        Failed::Stopped(stopped)
    }
}
