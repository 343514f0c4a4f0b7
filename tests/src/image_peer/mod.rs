//! Small images in the twin and in the npm package `rp2040js`: the same bytes, the same surroundings, and what each makes of them.
//!
//! ```text
//!   image + scenario ─┬─ twin_side ──────────────────────────┬─ compare: records of the trace with their cycles, changes of
//!                     └─ js_side (node, image_peer.mjs) ─────┘   watched pins with theirs, bytes of UART and USB
//! ```
//! Cycles count from the first record, since the peer has no ROM and no waits of flash. Where the peer departs from the datasheet its
//! side is amended by name and count (`tests/peers/image_accepted.txt`); an amendment without a line there, or a line that a full run
//! never needs, is unexplained. What is left must agree in value and in cycle.

mod compare;
mod js_side;
mod scenario;
mod twin_side;

use std::collections::BTreeMap;
use std::path::Path;

pub use compare::{Accepted, Outcome};
pub use js_side::find_node;
pub use scenario::{SCENARIOS, Scenario};

/// What one side did.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Account {
    /// Records of the trace: cycle, tag, value.
    pub records: Vec<(u64, u32, u32)>,
    /// Changes of the watched pins after the mark: cycle, levels.
    pub pins: Vec<(u64, u32)>,
    /// What came out without a cycle, by name.
    pub bytes: BTreeMap<String, Vec<u8>>,
    /// Amendments that were at work.
    pub amended: BTreeMap<String, u64>,
    /// The image's own end mark.
    pub end: u32,
    /// What went wrong beside it.
    pub errors: Vec<String>,
}

/// Runs one image on both sides and compares.
pub fn run(
    scenario: &Scenario,
    images: &Path,
    packages: &Path,
    accepted: &Accepted,
) -> Result<Outcome, String> {
    let path = images.join(format!("{}.bin", scenario.image));
    let image = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let twin = twin_side::run(scenario, &image)?;
    let peer = js_side::run(scenario, &path, packages)?;
    Ok(compare::compare(scenario, &twin, &peer, accepted))
}
