//! What the firmware is made of besides our own code, and under which licences: `AT+3RD_PARTY_LICENSES`.

/// A line a crate of the images: `<crate>: <licence>`. Written by `cargo xtask manual`, and compared with what cargo says by a test of `xtask`.
pub const LICENSES: &str = include_str!("licenses.txt");
