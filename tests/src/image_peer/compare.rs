//! Two accounts side by side.

use std::collections::BTreeMap;

use super::Account;
use super::scenario::Scenario;

/// The image's end mark.
const DONE: u32 = 0x600d;
/// Differences shown an image.
const SHOWN: usize = 8;

/// The table of amendments: name and reason.
pub struct Accepted(pub BTreeMap<String, String>);

impl Accepted {
    /// Reads `tests/peers/image_accepted.txt`.
    pub fn read() -> Result<Self, String> {
        let path = crate::root().join("tests/peers/image_accepted.txt");
        let text = std::fs::read_to_string(&path)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        let mut table = BTreeMap::new();
        for line in text
            .lines()
            .filter(|l| !l.is_empty() && !l.starts_with('#'))
        {
            let parts: Vec<&str> = line.split('|').map(str::trim).collect();
            let [name, reason, section] = parts[..] else {
                return Err(format!("{}: not three parts: {line}", path.display()));
            };
            table.insert(name.to_owned(), format!("{reason} ({section})"));
        }
        Ok(Self(table))
    }
}

/// What a comparison found.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Records, pin changes and bytes compared.
    pub compared: u64,
    /// Of these, equal in value and cycle.
    pub agreed: u64,
    /// Equal in value where cycles are not compared.
    pub accepted: u64,
    /// All else, as text.
    pub unexplained: Vec<String>,
    /// Amendments of the peer's side and how often each was at work.
    pub amended: BTreeMap<String, u64>,
}

/// Compares.
pub fn compare(
    scenario: &Scenario,
    twin: &Account,
    peer: &Account,
    accepted: &Accepted,
) -> Outcome {
    let mut outcome = Outcome {
        amended: peer.amended.clone(),
        ..Outcome::default()
    };
    let first = |account: &Account| account.records.first().map_or(0, |record| record.0);
    let since = |cycle: u64, start: u64| cycle.wrapping_sub(start) as i64;
    let records = |account: &Account| -> Vec<(i64, String)> {
        let line = |r: &(u64, u32, u32)| {
            (
                since(r.0, first(account)),
                format!("record {:#04x} = {:#x}", r.1, r.2),
            )
        };
        account.records.iter().map(line).collect()
    };
    outcome.stamped(scenario, "records", &records(twin), &records(peer));
    let pins = |account: &Account| -> Vec<(i64, String)> {
        let line = |p: &(u64, u32)| (since(p.0, first(account)), format!("pins {:#x}", p.1));
        account.pins.iter().map(line).collect()
    };
    outcome.stamped(scenario, "pin changes", &pins(twin), &pins(peer));
    for (name, bytes) in &twin.bytes {
        let other = peer.bytes.get(name).map(Vec::as_slice).unwrap_or(&[]);
        outcome.bytes(name, bytes, other);
    }
    for (side, end) in [("the twin", twin.end), ("the peer", peer.end)] {
        if end != DONE {
            outcome
                .unexplained
                .push(format!("{side} did not come to the image's end: {end:#x}"));
        }
    }
    outcome.unexplained.extend(peer.errors.iter().cloned());
    for name in peer.amended.keys() {
        if !accepted.0.contains_key(name) {
            outcome
                .unexplained
                .push(format!("the amendment {name} has no line in the table"));
        }
    }
    outcome
}

impl Outcome {
    fn stamped(
        &mut self,
        scenario: &Scenario,
        what: &str,
        twin: &[(i64, String)],
        peer: &[(i64, String)],
    ) {
        let mut shown = 0;
        for n in 0..twin.len().max(peer.len()) {
            self.compared += 1;
            match (twin.get(n), peer.get(n)) {
                (Some(t), Some(p)) if t == p => self.agreed += 1,
                (Some(t), Some(p)) if t.1 == p.1 && !scenario.stamped => self.accepted += 1,
                (t, p) => {
                    let text = |side: Option<&(i64, String)>| match side {
                        Some((cycle, text)) => format!("{text} at {cycle}"),
                        None => "nothing".into(),
                    };
                    if shown < SHOWN {
                        shown += 1;
                        let (t, p) = (text(t), text(p));
                        self.unexplained
                            .push(format!("{what} {n}: twin {t}, peer {p}"));
                    }
                }
            }
        }
        if shown == SHOWN {
            self.unexplained.push(format!("{what}: and perhaps more"));
        }
    }

    fn bytes(&mut self, name: &str, twin: &[u8], peer: &[u8]) {
        self.compared += twin.len().max(peer.len()) as u64;
        if twin == peer {
            self.agreed += twin.len() as u64;
        } else {
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            self.unexplained.push(format!(
                "{name}: twin {:?}, peer {:?}",
                text(twin),
                text(peer)
            ));
        }
    }
}
