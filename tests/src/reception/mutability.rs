//! Debian's `dump1090-mutability --fix` on a file of samples at 2.4 Msps.
//!
//! Its long output is read: a frame's line, then lines about it, one of which tells corrected bits. The frame is printed as corrected.

use super::Decoded;
use std::path::Path;
use std::process::Command;

/// The program.
pub const PROGRAM: &str = "dump1090-mutability";
/// The rate it works at, Hz.
pub const RATE_HZ: u64 = 2_400_000;

/// Whether it is installed; otherwise what to do.
pub fn find() -> Result<(), String> {
    match Command::new(PROGRAM).arg("--help").output() {
        Ok(_) => Ok(()),
        Err(cause) => Err(format!(
            "{PROGRAM}, the decoder to compare with, does not run ({cause}); install it: apt-get install {PROGRAM}"
        )),
    }
}

/// Decodes a file; `format` is `UC8` or `SC16`.
pub fn decode(path: &Path, format: &str) -> Result<Vec<Decoded>, String> {
    let output = Command::new(PROGRAM)
        .arg("--ifile")
        .arg(path)
        .args(["--iformat", format, "--fix"])
        .output()
        .map_err(|cause| format!("{PROGRAM}: {cause}"))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(format!("{PROGRAM} failed: {said}"));
    }
    Ok(parse(&String::from_utf8_lossy(&output.stdout)))
}

fn parse(text: &str) -> Vec<Decoded> {
    let mut frames: Vec<Decoded> = Vec::new();
    for line in text.lines() {
        if let Some(hex) = line.strip_prefix('*').and_then(|l| l.strip_suffix(';')) {
            frames.push(Decoded {
                bytes: bytes(hex),
                repaired: 0,
                arrival_ps: None,
            });
        } else if let (Some(bits), Some(frame)) = (
            line.strip_prefix("No. of bit errors fixed: "),
            frames.last_mut(),
        ) {
            frame.repaired = bits.trim().parse().unwrap_or(1);
        }
    }
    frames
}

fn bytes(hex: &str) -> Vec<u8> {
    let pairs = hex.as_bytes().chunks_exact(2);
    pairs
        .filter_map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_their_corrected_bits_are_read() {
        let text = "*5dab1c041bfb6b;\nCRC: 000000\n\n*8dac741cea485864893c08c8d29e;\nCRC: 000000\nNo. of bit errors fixed: 1\n";
        let frames = parse(text);
        let repaired: Vec<(usize, u8)> =
            frames.iter().map(|f| (f.bytes.len(), f.repaired)).collect();
        assert_eq!(repaired, [(7, 0), (14, 1)]);
    }
}
