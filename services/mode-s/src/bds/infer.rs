//! Which register a Comm-B reply copies (docs/adr/0014).
//!
//! ```text
//!   MB ─► all zeros ─────────────────────────────────────► Empty
//!      └► each of nine registers: layout, physics, Known ─► contradicted: struck out
//!                                                         └► agreements counted
//!           none left ─► Unknown      enough of them, and more than any other by a margin ─► Found      else ─► Ambiguous
//! ```
//! A register that 1,7 leaves out is struck out, too; one that it announces has an agreement more. Budget: a layout is refused by its first wrong status bit, most after two
//! or three fields.

use super::{Bds, Fit, Known, Register};
use crate::frame::MeBits;

/// What is to be thought of an MB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inference {
    /// All zeros: the transponder has nothing in that register.
    Empty,
    /// No register that is decoded here.
    Unknown,
    /// One of several, or one that too little speaks for.
    Ambiguous(Candidates),
    /// This one.
    Found(Register),
}

impl Inference {
    /// The register, where it is sure enough.
    pub const fn found(self) -> Option<Register> {
        match self {
            Inference::Found(register) => Some(register),
            _ => None,
        }
    }
}

/// Registers that an MB may copy, a bit each in the order of [`Bds::DECODED`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Candidates(u16);

impl Candidates {
    /// The registers.
    pub fn iter(self) -> impl Iterator<Item = Bds> {
        let numbered = Bds::DECODED.into_iter().enumerate();
        numbered
            .filter(move |&(place, _)| self.0 >> place & 1 == 1)
            .map(|(_, bds)| bds)
    }
}

/// Agreements that a register needs, and by how many it must lead.
const ENOUGH: u8 = 2;
const MARGIN: u8 = 2;
/// What a mark of eight bits and fields that may not be anything else are worth.
const MARK: u8 = 3;

/// Guesses which register an MB copies.
pub fn infer(mb: MeBits, known: &Known) -> Inference {
    if mb.is_zero() {
        return Inference::Empty;
    }
    let mut candidates = Candidates::default();
    let mut best: Option<(u8, Register)> = None;
    let mut second = 0;
    for (place, bds) in Bds::DECODED.into_iter().enumerate() {
        let announced = known
            .announced
            .and_then(|registers| registers.announces(bds));
        if announced == Some(false) {
            continue;
        }
        let Some(register) = Register::decode(bds, mb) else {
            continue;
        };
        let Some(agreements) = fit(&register, known) else {
            continue;
        };
        let agreements = agreements + u8::from(announced == Some(true));
        candidates.0 |= 1 << place;
        match best {
            Some((most, _)) if agreements <= most => second = second.max(agreements),
            _ => {
                second = best.map_or(second, |(most, _)| second.max(most));
                best = Some((agreements, register));
            }
        }
    }
    let is_alone = candidates.0.is_power_of_two();
    match best {
        None => Inference::Unknown,
        Some((agreements, register))
            if agreements >= ENOUGH && (is_alone || agreements >= second + MARGIN) =>
        {
            Inference::Found(register)
        }
        Some(_) => Inference::Ambiguous(candidates),
    }
}

fn fit(register: &Register, known: &Known) -> Fit {
    match register {
        Register::DataLinkCapability(_) | Register::GicbCapability(_) | Register::AcasRa(_) => {
            Some(MARK)
        }
        Register::AircraftIdentification(identification) => identification.fit(known),
        Register::SelectedVerticalIntention(intention) => intention.fit(),
        Register::MetRoutineReport(report) => report.fit(known),
        Register::MetHazardReport(report) => report.fit(known),
        Register::TrackAndTurn(turn) => turn.fit(known),
        Register::HeadingAndSpeed(speed) => speed.fit(known),
    }
}

#[cfg(test)]
#[path = "infer_tests.rs"]
mod tests;
