//! A pulse source that can be played again, so that a copy of a running board hears what the board hears.
//!
//! Sources read files and hold noise generators; they are not copied. A copy makes the source anew and repeats to it everything the first
//! one was asked and told, which gives the same edges, since sources are deterministic.

use std::sync::Arc;

use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::front_end::{Edge, PulseSource};

/// Makes the source anew, at its start.
pub type Again = Arc<dyn Fn() -> Box<dyn PulseSource + Send> + Send + Sync>;

/// A source and what is needed to repeat it.
pub(super) struct Repeated {
    source: Box<dyn PulseSource + Send>,
    again: Option<Again>,
    /// Questions so far: playback time up to which edges were asked for, and the trigger level told before it, if one was.
    asked: Vec<(u64, Option<f64>)>,
    /// Trigger level told since the last question.
    told: Option<f64>,
    /// Mark of all edges it gave, so that another source is noticed.
    given: u64,
}

impl Repeated {
    /// A source that cannot be repeated.
    pub(super) fn once(source: Box<dyn PulseSource + Send>) -> Self {
        Self {
            source,
            again: None,
            asked: Vec::new(),
            told: None,
            given: 0,
        }
    }

    /// A source that can.
    pub(super) fn again(again: Again) -> Self {
        Self {
            again: Some(Arc::clone(&again)),
            ..Self::once(again())
        }
    }

    pub(super) fn is_repeatable(&self) -> bool {
        self.again.is_some()
    }

    pub(super) fn set_trigger_level_mv(&mut self, mv: f64) {
        self.source.set_trigger_level_mv(mv);
        self.told = Some(mv);
    }

    pub(super) fn next_edges(&mut self, until_ps: u64, out: &mut Vec<Edge>) {
        let known = out.len();
        self.source.next_edges(until_ps, out);
        if self.again.is_some() {
            self.asked.push((until_ps, self.told.take()));
            self.given = marked(self.given, &out[known..]);
        }
    }

    pub(super) fn finished(&self) -> bool {
        self.source.finished()
    }

    pub(super) fn detector_mv(&self, at_ps: u64) -> Option<f32> {
        self.source.detector_mv(at_ps)
    }
}

impl Clone for Repeated {
    /// # Panics
    /// Where the source cannot be repeated; `Board::fork` asks before.
    fn clone(&self) -> Self {
        let Some(again) = &self.again else {
            panic!(
                "what plays into PULSES cannot be repeated; start it with Board::play_repeatable"
            );
        };
        Self::repeat(again, &self.asked, self.told)
    }
}

impl Repeated {
    /// The source made anew, and told and asked what the first one was.
    fn repeat(again: &Again, asked: &[(u64, Option<f64>)], told: Option<f64>) -> Self {
        let mut source = again();
        let mut given = 0;
        let mut gone = Vec::new();
        for (until_ps, told) in asked {
            if let Some(mv) = told {
                source.set_trigger_level_mv(*mv);
            }
            source.next_edges(*until_ps, &mut gone);
            given = marked(given, &gone);
            gone.clear();
        }
        if let Some(mv) = told {
            source.set_trigger_level_mv(mv);
        }
        Self {
            source,
            again: Some(Arc::clone(again)),
            asked: asked.to_vec(),
            told,
            given,
        }
    }

    /// What was read from a snapshot plays on, once the source is given. False, and nothing changed, if it is another one.
    pub(super) fn resume(&mut self, again: &Again) -> bool {
        let repeated = Self::repeat(again, &self.asked, self.told);
        let same = repeated.given == self.given;
        if same {
            *self = repeated;
        }
        same
    }
}

/// The mark with these edges after it.
fn marked(mark: u64, edges: &[Edge]) -> u64 {
    edges.iter().fold(mark, |mark, edge| {
        (mark ^ edge.at_ps << 1 ^ u64::from(edge.level)).wrapping_mul(0x100_0000_01b3)
    })
}

/// What a snapshot keeps of a source: what it was asked and told, and the mark of what it gave.
#[derive(Serialize, Deserialize)]
struct Asked {
    asked: Vec<(u64, Option<f64>)>,
    told: Option<f64>,
    given: u64,
}

impl Serialize for Repeated {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if !self.is_repeatable() {
            return Err(S::Error::custom(
                "what plays into PULSES cannot be repeated",
            ));
        }
        let Self {
            source: _,
            again: _,
            asked,
            told,
            given,
        } = self;
        Asked {
            asked: asked.clone(),
            told: *told,
            given: *given,
        }
        .serialize(to)
    }
}

impl<'de> Deserialize<'de> for Repeated {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let Asked { asked, told, given } = Asked::deserialize(from)?;
        Ok(Self {
            source: Box::new(NotYet),
            again: None,
            asked,
            told,
            given,
        })
    }
}

/// Stands for the source of a board just read from a snapshot, until [`Repeated::resume`].
struct NotYet;

impl PulseSource for NotYet {
    fn next_edges(&mut self, _: u64, _: &mut Vec<Edge>) {}

    fn finished(&self) -> bool {
        true
    }

    fn set_trigger_level_mv(&mut self, _: f64) {}
}
