//! What reception is measured with: scenes and recordings, the engines, a peer on the same samples, and fair counts.
//!
//! | file | what |
//! |---|---|
//! | `arrival` | errors of the time of arrival |
//! | `evidence` | what eight samples of a half bit say, learned from scenes |
//! | `fair` | which decoded frames of a recording count |
//! | `genie` | what could be decoded at best, the starts being known |
//! | `native` | a scene or recording through a slicer and the native engine |
//! | `device` | the same through the shipped image in the twin |
//! | `limit` | long frames back to back |
//! | `mode_ac` | Mode A/C replies against a scene's truth |
//! | `mutability` | Debian's dump1090-mutability on the same samples |
//! | `nothing` | air in which nobody sends, for what is invented |
//! | `points` | the simulated scenes, and what the prototype study measured on such |
//! | `recordings` | the recordings of `../shared/data` |
//! | `score` | decoded frames against a scene's truth |
//! | `table` | the sensitivity table that is committed |

pub mod arrival;
pub mod device;
pub mod evidence;
pub mod fair;
pub mod genie;
pub mod limit;
pub mod mode_ac;
pub mod mutability;
pub mod native;
pub mod nothing;
pub mod points;
pub mod recordings;
pub mod score;
pub mod table;

/// A frame that a decoder gave.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded {
    pub bytes: Vec<u8>,
    /// Bits that were corrected.
    pub repaired: u8,
    /// Arrival of the frame's first edge in playback time, ps, where the decoder gives one.
    pub arrival_ps: Option<i64>,
}
