//! Counts agreements, and explains each difference by a line of the accepted table or not at all.

use crate::view::{Field, Said};
use mode_s::{Frame, Message};
use std::collections::BTreeMap;
use tests::logs::Log;

/// A decoder to compare with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Peer {
    Rs1090,
    AdsbDeku,
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// Whether the frame is taken at all: 1 or 0.
    Taken,
    /// A field of a frame.
    Of(Field),
    /// A place from an even and an odd message.
    GlobalPlace,
    /// A place from one message and a place near by.
    LocalPlace,
    /// A field of a tracked aircraft after a frame.
    Tracked(Field),
    /// The place of a tracked aircraft after a position message.
    TrackedPlace,
    /// A field of a Comm-B register, by rs1090's name.
    Register(&'static str),
}

/// One difference.
pub struct Difference<'a> {
    pub peer: Peer,
    pub subject: Subject,
    pub ours: Said,
    pub theirs: Said,
    pub frame: &'a Frame,
}

impl Difference<'_> {
    /// Our reading of the frame.
    pub fn message(&self) -> Message {
        Message::decode(self.frame)
    }

    /// Whether it is about a field of the frame, or the same field of the tracked aircraft.
    pub fn is_of(&self, field: Field) -> bool {
        self.subject == Subject::Of(field) || self.subject == Subject::Tracked(field)
    }
}

/// A difference that is understood and stays.
pub struct Accepted {
    pub peer: Peer,
    /// Why it stays.
    pub reason: &'static str,
    /// Which differences are meant.
    pub applies: fn(&Difference) -> bool,
    /// How often, in the long flight and in the lax log.
    pub counts: [u32; 2],
}

/// How many differences without a line are printed of each peer and subject.
const PRINTED: usize = 3;

/// The count of one log.
pub struct Ledger {
    log: Log,
    table: &'static [Accepted],
    compared: BTreeMap<Peer, u32>,
    agreed: u32,
    accepted: Vec<u32>,
    unexplained: BTreeMap<(Peer, Subject), Vec<String>>,
}

impl Ledger {
    pub fn new(log: Log, table: &'static [Accepted]) -> Ledger {
        Ledger {
            log,
            table,
            compared: BTreeMap::new(),
            agreed: 0,
            accepted: vec![0; table.len()],
            unexplained: BTreeMap::new(),
        }
    }

    /// Takes one comparison; the first line of the table that applies takes a difference.
    pub fn compare(&mut self, is_same: bool, difference: Difference<'_>) {
        *self.compared.entry(difference.peer).or_default() += 1;
        if is_same {
            self.agreed += 1;
            return;
        }
        let line = self
            .table
            .iter()
            .position(|line| line.peer == difference.peer && (line.applies)(&difference));
        match line {
            Some(line) => self.accepted[line] += 1,
            None => {
                let kind = (difference.peer, difference.subject);
                let text = format!(
                    "ours {:?}, theirs {:?} in {:?}",
                    difference.ours, difference.theirs, difference.frame
                );
                self.unexplained.entry(kind).or_default().push(text);
            }
        }
    }

    /// Prints the sums and fails where a difference is unexplained or a count is not the committed one.
    pub fn close(self, compared: [(Peer, u32); 2]) {
        let column = self.log as usize;
        for (line, &count) in self.table.iter().zip(&self.accepted) {
            if count != 0 {
                println!("{count:8} {}", line.reason);
            }
        }
        for ((peer, subject), differences) in &self.unexplained {
            println!("unexplained: {} {peer:?} {subject:?}", differences.len());
            for difference in differences.iter().take(PRINTED) {
                println!("    {difference}");
            }
        }
        let unexplained: usize = self.unexplained.values().map(Vec::len).sum();
        println!(
            "{}: compared={} agreed={} accepted={} unexplained={}",
            self.log.name(),
            self.compared.values().sum::<u32>(),
            self.agreed,
            self.accepted.iter().sum::<u32>(),
            unexplained
        );
        assert_eq!(unexplained, 0, "differences without a reason");
        let moved: Vec<String> = self
            .table
            .iter()
            .zip(&self.accepted)
            .filter(|(line, count)| line.counts[column] != **count)
            .map(|(line, count)| {
                format!("{} (table {}): {}", count, line.counts[column], line.reason)
            })
            .collect();
        assert!(moved.is_empty(), "counts moved: {moved:#?}");
        assert_eq!(self.compared, BTreeMap::from(compared), "comparisons");
    }
}

/// Our ground speeds are rounded to a knot.
const SPEED_ROUNDING_KT: f64 = 0.501;
/// Our angles are rounded to 0.01 degrees, and CORDIC adds as much again.
const ANGLE_ROUNDING_DEGREES: f64 = 0.015;

/// Whether two readings of a field say the same.
pub fn is_same(field: Field, ours: &Said, theirs: &Said) -> bool {
    let (Some(a), Some(b)) = (ours.number(), theirs.number()) else {
        return ours == theirs;
    };
    let away = (a - b).abs();
    match field {
        Field::GroundSpeed => away <= SPEED_ROUNDING_KT,
        // f32 against tenths.
        Field::PressureSetting => away <= 0.001,
        Field::Track | Field::Heading | Field::SelectedHeading => {
            away.min(360.0 - away) <= ANGLE_ROUNDING_DEGREES
        }
        _ => away == 0.0,
    }
}
