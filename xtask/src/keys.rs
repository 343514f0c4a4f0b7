//! The key images are signed with. A checkout makes itself a development key at first use; it stays in the target folder, is accepted by
//! this checkout's own bootloader alone, and says nothing about who made an image.
//!
//! `SQUITTER_SIGNING_KEY` names a file with another one, as `squitter keygen` makes it. `SQUITTER_ACCEPTED_KEYS` names `.pub` files, separated by
//! commas, of keys that the bootloader shall accept too: the next one, for a rotation, or the release's while another signs.

use crate::workspace;
use release::keys;
use std::path::PathBuf;

use ed25519_compact::KeyPair;

/// Names the file of a key that is not the checkout's own.
const KEY_FILE: &str = "SQUITTER_SIGNING_KEY";
/// Names the files of further public keys.
const PUBLIC_FILES: &str = "SQUITTER_ACCEPTED_KEYS";

/// The key to sign with.
pub fn signing() -> Result<KeyPair, String> {
    let path = match std::env::var_os(KEY_FILE) {
        Some(path) => PathBuf::from(path),
        None => development()?,
    };
    keys::read_secret(&path)
}

/// The public keys, as the bootloader's build script takes them: the signer's, and those that were asked for.
pub fn accepted(signer: &KeyPair) -> Result<String, String> {
    let mut accepted = vec![keys::hex(&*signer.pk)];
    let files = std::env::var(PUBLIC_FILES).unwrap_or_default();
    for file in files.split(',').filter(|file| !file.is_empty()) {
        let public = keys::hex(&keys::read_public(&PathBuf::from(file))?);
        if !accepted.contains(&public) {
            accepted.push(public);
        }
    }
    Ok(accepted.join(","))
}

/// The file of the checkout's own key, made with its public half if it is missing.
fn development() -> Result<PathBuf, String> {
    let folder = workspace::target()?.join("keys");
    let path = folder.join("development.key");
    if !path.exists() {
        eprintln!("xtask: making a development key for this checkout, target/keys/development.key");
        std::fs::create_dir_all(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
        keys::write_secret(&path, &keys::generate()?)?;
    }
    let public = folder.join("development.pub");
    if !public.exists() {
        keys::write_public(&public, &keys::read_secret(&path)?)?;
    }
    Ok(path)
}
