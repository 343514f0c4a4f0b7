//! The keys images are signed with. A checkout makes itself a development key at first use; it stays in the target folder, is accepted by
//! this checkout's own bootloader alone, and says nothing about who made an image.
//!
//! `SQUITTER_SIGNING_KEY` names a file with another one: 64 hexadecimal digits, the Ed25519 seed. A release is signed so.

use crate::workspace;
use boot_core::keys::PUBLIC_KEY;
use ed25519_compact::{KeyPair, Seed};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes of a seed.
const SEED: usize = 32;
/// Names the file of a key that is not the checkout's own.
const KEY_FILE: &str = "SQUITTER_SIGNING_KEY";

/// The key to sign with.
pub fn signing() -> Result<KeyPair, String> {
    let path = match std::env::var_os(KEY_FILE) {
        Some(path) => PathBuf::from(path),
        None => development()?,
    };
    let text =
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let seed = seed(text.trim()).ok_or(format!(
        "{}: not {} hexadecimal digits",
        path.display(),
        2 * SEED
    ))?;
    Ok(KeyPair::from_seed(Seed::new(seed)))
}

/// The public half, as the bootloader's build script takes it.
pub fn public_hex(pair: &KeyPair) -> String {
    let public: [u8; PUBLIC_KEY] = *pair.pk;
    public.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The file of the checkout's own key, made if it is missing.
fn development() -> Result<PathBuf, String> {
    let folder = workspace::target()?.join("keys");
    let path = folder.join("development.key");
    if !path.exists() {
        eprintln!("xtask: making a development key for this checkout, target/keys/development.key");
        std::fs::create_dir_all(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
        let seed = random()?;
        let text: String = seed.iter().map(|byte| format!("{byte:02x}")).collect();
        write_private(&path, &text)?;
    }
    Ok(path)
}

fn random() -> Result<[u8; SEED], String> {
    let mut seed = [0; SEED];
    std::fs::File::open("/dev/urandom")
        .and_then(|mut source| source.read_exact(&mut seed))
        .map_err(|error| format!("/dev/urandom: {error}"))?;
    Ok(seed)
}

/// Readable by its owner alone.
fn write_private(path: &Path, text: &str) -> Result<(), String> {
    use std::io::Write;
    use std::os::unix::fs::OpenOptionsExt;
    std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(0o600)
        .open(path)
        .and_then(|mut file| writeln!(file, "{text}"))
        .map_err(|error| format!("{}: {error}", path.display()))
}

fn seed(hex: &str) -> Option<[u8; SEED]> {
    if hex.len() != 2 * SEED || !hex.is_ascii() {
        return None;
    }
    let mut seed = [0; SEED];
    for (n, byte) in seed.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&hex[2 * n..2 * n + 2], 16).ok()?;
    }
    Some(seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_is_64_hexadecimal_digits() {
        assert_eq!(seed(&"0f".repeat(32)), Some([0x0F; 32]));
        for bad in [
            "",
            "0f",
            &"0f".repeat(31),
            &"0g".repeat(32),
            &"é".repeat(32),
        ] {
            assert_eq!(seed(bad), None, "{bad}");
        }
    }
}
