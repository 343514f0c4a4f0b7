//! NMEA pass-through: sentences of the GNSS as they came, all of them or RMC only.
//!
//! ```text
//!   $<talker ×2><type ×3>,…*hh\r\n       passed whole and unchanged, or not at all
//! ```
//! A line that is no whole sentence (no `$` or `!` in front, a byte outside printable ASCII, a checksum that is wrong) is torn and has the
//! length 0: nothing is to be sent. What it is not: it understands no sentence; that is the `nmea` service's.

use crate::Full;

/// A slice that holds any sentence: 82 bytes by the standard; some receivers send longer ones of their own.
pub const MAX_SENTENCE: usize = 160;

/// Which sentences pass (`GNSS_LOG`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pass {
    /// 1: RMC of any talker.
    RmcOnly,
    /// 2: every sentence.
    #[default]
    All,
}

/// A sentence as received, with or without its line end; what passes goes out with `\r\n`.
pub fn sentence(line: &[u8], pass: Pass, out: &mut [u8]) -> Result<usize, Full> {
    let line = line.trim_ascii_end();
    if !is_whole(line) || pass == Pass::RmcOnly && line.get(3..6) != Some(b"RMC".as_slice()) {
        return Ok(0);
    }
    let (text, rest) = out.split_at_mut_checked(line.len()).ok_or(Full)?;
    let end = rest.first_chunk_mut().ok_or(Full)?;
    text.copy_from_slice(line);
    *end = *b"\r\n";
    Ok(line.len() + end.len())
}

fn is_whole(line: &[u8]) -> bool {
    let Some((b'$' | b'!', body)) = line.split_first() else {
        return false;
    };
    if !body.iter().all(|byte| (b' '..=b'~').contains(byte)) {
        return false;
    }
    let Some(star) = body.iter().rposition(|&byte| byte == b'*') else {
        // The standard lets the checksum be left out.
        return true;
    };
    let sum = body[..star].iter().fold(0, |sum, byte| sum ^ byte);
    match body[star + 1..] {
        [high, low] => digit(high).zip(digit(low)).map(|(h, l)| h << 4 | l) == Some(sum),
        _ => false,
    }
}

fn digit(byte: u8) -> Option<u8> {
    char::from(byte).to_digit(16).map(|digit| digit as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RMC: &[u8] = b"$GNRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*74";
    const FLARM: &[u8] = b"$PFLAU,3,1,2,1,0,,0,,*63";

    fn passed(line: &[u8], pass: Pass) -> std::vec::Vec<u8> {
        let mut out = [0; MAX_SENTENCE];
        let length = sentence(line, pass, &mut out).unwrap();
        out[..length].to_vec()
    }

    #[test]
    fn whole_sentences_pass_unchanged() {
        for line in [RMC, FLARM, b"$GPZDA,1", b"$GPTXT,01*2c"] {
            let line = match line {
                b"$GPTXT,01*2c" => &b"$PFLAA,0,100,-150,10,2,DDA85C,123,13,24,1.4,2*7f"[..],
                _ => line,
            };
            let sent = passed(&[line, b"\r\n"].concat(), Pass::All);
            assert_eq!(sent, [line, b"\r\n"].concat());
            assert_eq!(passed(line, Pass::All), sent);
        }
    }

    #[test]
    fn rmc_only_is_rmc_of_any_talker() {
        assert!(!passed(RMC, Pass::RmcOnly).is_empty());
        assert!(passed(FLARM, Pass::RmcOnly).is_empty());
        assert!(passed(b"$GPRM", Pass::RmcOnly).is_empty());
    }

    #[test]
    fn torn_sentences_do_not_pass() {
        for line in [
            &b""[..],
            b"GNRMC,1",
            b"$PFLAU,3,1,2,1,0,,0,,*6",
            b"$PFLAU,3,1,2,1,0,,0,,*64",
            b"$PFLAU,3,1,2,1,0,,0,\x00,*63",
            b"$PFLAU,3,1,2,1,0,,0,,*633",
        ] {
            assert!(passed(line, Pass::All).is_empty(), "{line:?}");
        }
    }

    #[test]
    fn a_slice_without_room_refuses() {
        let mut out = [0; MAX_SENTENCE];
        for short in 0..RMC.len() + 2 {
            assert_eq!(sentence(RMC, Pass::All, &mut out[..short]), Err(Full));
        }
    }
}
