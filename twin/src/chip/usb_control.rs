//! A control transfer of the host and the stage it is in (USB 2.0, 8.5.3).

use serde::{Deserialize, Serialize};

/// Where it stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Stage {
    Setup,
    DataIn,
    DataOut,
    StatusIn,
    StatusOut,
}

/// The transfer.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Control {
    pub setup: [u8; 8],
    pub data: Vec<u8>,
    /// The driver outside that wants to know how it ended calls it so.
    #[serde(skip)]
    pub id: Option<u32>,
}
