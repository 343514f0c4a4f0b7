//! Fuzzing of what is typed: lines mutated from every command, byte by byte through the reader, answered by a device without hardware.
//!
//! | must hold | |
//! |---|---|
//! | no panic | built with overflow checks |
//! | one reply | a line of printable text on CONSOLE is answered by one `OK`, `ERROR …`, value or list; on COMMS_UART in RUN by nothing but the two commands it knows |
//! | a refusal changes nothing | settings and state are as before |
//! | the set goes together | after every line |

use crate::dice::Dice;
use settings::choices::Protocol;
use settings::{ENTRIES, Port};
use shell::model::Model;
use shell::{After, Input, LineReader, Machine, Place, State, Step, answer};

/// What was wrong, with the line.
#[derive(Debug)]
pub struct Wrong {
    /// The bytes sent.
    pub line: String,
    /// What was said.
    pub said: Vec<String>,
    /// What must not be.
    pub why: &'static str,
}

/// What a run reached.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reached {
    pub lines: u64,
    pub accepted: u64,
    pub refused: u64,
    pub lists: u64,
    pub moves: u64,
    pub silent: u64,
    pub too_long: u64,
}

/// Sends so many lines of a seed.
pub fn run(seed: u64, lines: u64) -> Result<Reached, Wrong> {
    let mut dice = Dice::new(seed);
    let mut subject = Subject::default();
    while subject.reached.lines < lines {
        subject.one(&mut dice)?;
    }
    Ok(subject.reached)
}

struct Subject {
    device: Model,
    machine: Machine,
    readers: [LineReader; 2],
    reached: Reached,
}

impl Default for Subject {
    fn default() -> Self {
        Self {
            device: Model::default(),
            machine: Machine::new(false),
            readers: [LineReader::new(), LineReader::new()],
            reached: Reached::default(),
        }
    }
}

impl Subject {
    fn one(&mut self, dice: &mut Dice) -> Result<(), Wrong> {
        self.reached.lines += 1;
        self.device.has_gain = dice.one_in(2);
        self.device.broken = dice.one_in(3).then_some("EEPROM");
        let port = Port::ALL[dice.below(2) as usize];
        let place = Place {
            port,
            state: self.machine.state(),
        };
        let line = line(dice);
        let before = self.device.clone();
        let mut said: Vec<String> = Vec::new();
        let (mut replies, mut moved) = (0, false);
        for &byte in &line {
            let Some(input) = self.readers[port as usize].feed(byte) else {
                continue;
            };
            replies += 1;
            self.reached.too_long += u64::from(input == Input::TooLong);
            let mut out = |text: std::fmt::Arguments<'_>| said.push(text.to_string());
            match answer(input, place, &mut self.device, &mut out) {
                After::Done | After::Saving(_) => {}
                After::List(mut listing) => {
                    self.reached.lists += 1;
                    while listing.turn(&self.device, place, &mut out) {}
                }
                After::Event(event, dialect) => {
                    self.reached.moves += 1;
                    moved = true;
                    for step in self.machine.take(event) {
                        match step {
                            Step::Answer => dialect.tell(&mut out, Ok::<(), &str>(())),
                            Step::Refuse => dialect.tell(&mut out, Err("not in this state")),
                            _ => {}
                        }
                    }
                }
            }
        }
        let wrong = |why| Wrong {
            line: line.escape_ascii().to_string(),
            said: said.clone(),
            why,
        };
        let is_silent = place.port == Port::CommsUart && place.state == State::Run;
        if replies > 1 {
            return Err(wrong("more than one line"));
        }
        if replies == 1 && !is_silent && said.is_empty() {
            return Err(wrong("no reply"));
        }
        if is_silent && !said.is_empty() && !moved {
            return Err(wrong("a reply among reports"));
        }
        let ends = said.iter().filter(|line| is_end(line)).count();
        if ends > 1 {
            return Err(wrong("two ends"));
        }
        let refused = said.iter().any(|line| is_refusal(line));
        if refused && !moved && self.device.settings != before.settings {
            return Err(wrong("a refusal that changed something"));
        }
        if self.device.settings.check().is_err() {
            return Err(wrong("a set that does not go together"));
        }
        if self.device.settings.console.protocol() == Protocol::Mixed
            && self.device.settings.console.is_binary()
        {
            return Err(wrong("a binary protocol in company"));
        }
        let reached = &mut self.reached;
        match (said.is_empty(), refused) {
            (true, _) => reached.silent += 1,
            (_, true) => reached.refused += 1,
            _ => reached.accepted += 1,
        }
        Ok(())
    }
}

fn is_refusal(line: &str) -> bool {
    line.starts_with("ERROR ") || line.starts_with("AT+ERROR (")
}

fn is_end(line: &str) -> bool {
    line == "OK" || line == "AT+OK" || is_refusal(line)
}

const ARGUMENTS: [&str; 34] = [
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "6",
    "7",
    "8",
    "100",
    "CONSOLE",
    "COMMS_UART",
    "COMMS",
    "GNSS",
    "NONE",
    "RAW",
    "BEAST",
    "CSBEE",
    "GDL90",
    "LEARN",
    "SAVE",
    "LOAD",
    "RESET",
    "DEFAULT",
    "FIXED",
    "ICAO",
    "53.42854",
    "-180",
    "4CA7E8",
    "3F",
    "115200",
    "3300",
    "-1",
    "99999999999999999999",
];

/// A command with arguments, then bytes of it changed, dropped, doubled or added.
fn line(dice: &mut Dice) -> Vec<u8> {
    let entry = &ENTRIES[dice.below(ENTRIES.len() as u64) as usize];
    let mut text = format!("AT+{}", entry.name);
    match dice.below(8) {
        0 => {}
        1 => text += "?",
        2 => text += "=?",
        3 => text += "?DUMP",
        _ => {
            text += "=";
            for index in 0..dice.below(4) {
                if index > 0 {
                    text += ",";
                }
                text += ARGUMENTS[dice.below(ARGUMENTS.len() as u64) as usize];
            }
        }
    }
    if dice.one_in(10) {
        text.make_ascii_lowercase();
    }
    let mut bytes = text.into_bytes();
    if dice.one_in(200) {
        bytes.resize(bytes.len() + 150, b'A');
    }
    for _ in 0..dice.below(4) {
        let at = dice.below(bytes.len() as u64) as usize;
        match dice.below(5) {
            0 => bytes[at] = dice.next() as u8,
            1 => bytes[at] ^= 1 << dice.below(7),
            2 if bytes.len() > 1 => drop(bytes.remove(at)),
            3 => bytes.insert(at, bytes[at]),
            _ => bytes.insert(at, b"AT+=?,"[dice.below(6) as usize]),
        }
    }
    // An end within would make two lines of it.
    bytes.retain(|byte| !matches!(byte, b'\r' | b'\n'));
    bytes.extend([&b"\r\n"[..], b"\n", b"\r"][dice.below(3) as usize]);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_mutated_lines_leave_nothing_impossible() {
        let reached = run(1090, 1_000_000).unwrap_or_else(|wrong| panic!("{wrong:#?}"));
        for (name, count) in [
            ("accepted", reached.accepted),
            ("refused", reached.refused),
            ("lists", reached.lists),
            ("moves", reached.moves),
            ("silent", reached.silent),
            ("too long", reached.too_long),
        ] {
            assert!(count >= 1_000, "{name} came {count} times in {reached:?}");
        }
    }
}
