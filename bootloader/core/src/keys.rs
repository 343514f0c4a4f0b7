//! Who may sign: the public keys a bootloader was built with, and the check of a signature against them.
//!
//! Ed25519 (RFC 8032). A release build holds the release keys, of which there may be two for rotation; a development build holds the
//! development key of its checkout beside them.

use boot_contract::header::{Header, KeyId, LEN};
use ed25519_compact::{PublicKey, Signature};
use sha2::{Digest, Sha256};

/// Bytes of a public key.
pub const PUBLIC_KEY: usize = 32;

/// The keys a bootloader accepts.
#[derive(Clone, Copy, Debug)]
pub struct Keys<'a>(pub &'a [[u8; PUBLIC_KEY]]);

/// The name of a public key in headers.
pub fn key_id(public: &[u8; PUBLIC_KEY]) -> KeyId {
    let digest = Sha256::digest(public);
    let mut id = [0; 8];
    id.copy_from_slice(&digest[..8]);
    id
}

/// What is wrong with a signature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignatureError {
    /// No key of this name is accepted here.
    UnknownKey,
    /// The key did not sign these bytes.
    Wrong,
}

impl Keys<'_> {
    /// Checks that one of the keys signed the header `decoded` from `bytes`. Takes some 24 million cycles on a Cortex-M0+.
    pub fn check(&self, decoded: &Header, bytes: &[u8; LEN]) -> Result<(), SignatureError> {
        let public = self
            .0
            .iter()
            .find(|public| key_id(public) == decoded.key)
            .ok_or(SignatureError::UnknownKey)?;
        let (signed, signature) = Header::signature(bytes);
        PublicKey::new(*public)
            .verify(signed, &Signature::new(signature))
            .map_err(|_| SignatureError::Wrong)
    }
}
