//! What the firmware is made of besides our own code, and under which licences: `AT+3RD_PARTY_LICENSES`.
//!
//! A test of `xtask` compares the table with the images' dependencies.

/// Name and licence of each crate that the images hold.
pub const LICENSES: &[(&str, &str)] = &[];
