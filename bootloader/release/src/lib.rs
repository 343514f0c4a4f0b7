//! What the tools on the host make of linked images, and how they check it again: one code for `cargo xtask fw` and `squitter`.
//!
//! | module | makes, or reads |
//! |---|---|
//! | [`elf`] | the parts of a linked image |
//! | [`keys`] | key files: a seed that signs, a public key that checks |
//! | [`package`] | the update package: both links, unsigned, signed, verified |
//! | [`flash_image`] | the flash of a first flashing: bootloader, empty log, slot A |
//! | [`uf2`] | the UF2 file of it, by `elf2uf2-rs`, read back |
//! | [`ymodem`] | the sending end of a transfer |
//!
//! Errors are texts for people: nothing here runs where a program could act on them.
#![forbid(unsafe_code)]

pub mod elf;
pub mod flash_image;
pub mod keys;
pub mod package;
pub mod uf2;
pub mod ymodem;
