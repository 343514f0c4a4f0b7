//! Key files: text of 64 hexadecimal digits, the seed of an Ed25519 key pair (secret, `.key`) or its public half (`.pub`).

use boot_core::keys::PUBLIC_KEY;
use ed25519_compact::{KeyPair, Seed};
use std::io::{Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

/// Bytes of a seed.
const SEED: usize = 32;

/// A public key.
pub type Public = [u8; PUBLIC_KEY];

/// Makes a key pair from the system's random bytes.
pub fn generate() -> Result<KeyPair, String> {
    let mut seed = [0; SEED];
    std::fs::File::open("/dev/urandom")
        .and_then(|mut source| source.read_exact(&mut seed))
        .map_err(|error| format!("/dev/urandom: {error}"))?;
    Ok(KeyPair::from_seed(Seed::new(seed)))
}

/// Writes the secret, readable by its owner alone. A file that exists is never overwritten: what it signed could not be updated any more.
pub fn write_secret(path: &Path, pair: &KeyPair) -> Result<(), String> {
    write(path, 0o600, &hex(&*pair.sk.seed()))
}

/// Writes the public half.
pub fn write_public(path: &Path, pair: &KeyPair) -> Result<(), String> {
    write(path, 0o644, &hex(&*pair.pk))
}

fn write(path: &Path, mode: u32, text: &str) -> Result<(), String> {
    std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(mode)
        .open(path)
        .and_then(|mut file| writeln!(file, "{text}"))
        .map_err(|error| format!("{}: {error}", path.display()))
}

/// Reads a secret.
pub fn read_secret(path: &Path) -> Result<KeyPair, String> {
    Ok(KeyPair::from_seed(Seed::new(read(path)?)))
}

/// Reads a public key.
pub fn read_public(path: &Path) -> Result<Public, String> {
    read(path)
}

fn read(path: &Path) -> Result<[u8; 32], String> {
    let text =
        std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    from_hex(text.trim()).ok_or(format!("{}: not 64 hexadecimal digits", path.display()))
}

/// As a file, and the bootloader's build script, take it.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn from_hex(hex: &str) -> Option<[u8; 32]> {
    if hex.len() != 64 || !hex.is_ascii() {
        return None;
    }
    let mut bytes = [0; 32];
    for (n, byte) in bytes.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&hex[2 * n..2 * n + 2], 16).ok()?;
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_64_hexadecimal_digits() {
        assert_eq!(from_hex(&"0f".repeat(32)), Some([0x0F; 32]));
        for bad in [
            "",
            "0f",
            &"0f".repeat(31),
            &"0g".repeat(32),
            &"é".repeat(32),
        ] {
            assert_eq!(from_hex(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_pair_is_read_back_and_no_file_is_overwritten() {
        use std::os::unix::fs::PermissionsExt;
        let folder = std::env::temp_dir().join(format!("squitter-keys-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (secret, public) = (folder.join("a.key"), folder.join("a.pub"));
        let pair = generate().unwrap();
        write_secret(&secret, &pair).unwrap();
        write_public(&public, &pair).unwrap();
        assert_eq!(*read_secret(&secret).unwrap().pk, *pair.pk);
        assert_eq!(read_public(&public).unwrap(), *pair.pk);
        let mode = std::fs::metadata(&secret).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        assert!(write_secret(&secret, &pair).is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
