//! What is typed in the BOOTLOADER state: lines in upper case, ended by CR, LF or both.
//!
//! | line | command |
//! |---|---|
//! | `AT` | nothing, answered |
//! | `AT+LOCK=1`, `AT+LOCK=0`, `AT+LOCK?` | stay here, go on, which of the two |
//! | `AT+BOOT?` | in BOOTLOADER? |
//! | `AT+UPDATE` | a package comes over YMODEM, on this port |
//! | `AT+REBOOT`, `AT+REBOOT_BOOTLOADER` | start again; start again and stay here |
//! | `AT+INFO`, `AT+DEVICE?`, `AT+FIRMWARE_VERSION?` | what is installed |
//! | `AT+HELP` | this list |
//!
//! A line that does not begin with `AT` is somebody else's traffic: it is dropped without an answer. A byte that is no printable ASCII begins the line
//! anew: a sender that was cancelled says good-bye with CAN and backspaces, and what is typed behind them counts.

/// Bytes of a line; more than any command has.
const MOST: usize = 48;

/// One command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    Attention,
    Lock,
    Unlock,
    IsLocked,
    IsBoot,
    Update,
    Reboot,
    RebootBootloader,
    Info,
    Device,
    FirmwareVersion,
    Help,
}

/// Every command with its line and its help.
pub const COMMANDS: [(&str, Command, &str); 12] = [
    ("AT", Command::Attention, "answers AT+OK"),
    ("AT+LOCK=1", Command::Lock, "stays in BOOTLOADER"),
    ("AT+LOCK=0", Command::Unlock, "starts the firmware"),
    ("AT+LOCK?", Command::IsLocked, "whether it stays"),
    ("AT+BOOT?", Command::IsBoot, "1 in BOOTLOADER"),
    (
        "AT+UPDATE",
        Command::Update,
        "takes an update package over YMODEM on this port",
    ),
    ("AT+REBOOT", Command::Reboot, "starts again"),
    (
        "AT+REBOOT_BOOTLOADER",
        Command::RebootBootloader,
        "starts again and stays in BOOTLOADER",
    ),
    ("AT+INFO", Command::Info, "both slots"),
    ("AT+DEVICE?", Command::Device, "the board's name"),
    (
        "AT+FIRMWARE_VERSION?",
        Command::FirmwareVersion,
        "version of the firmware that would start",
    ),
    ("AT+HELP", Command::Help, "this list"),
];

/// What a byte completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Typed {
    Nothing,
    Command(Command),
    /// An `AT` line that is no command here.
    Unknown,
    /// An `AT` line longer than any command.
    TooLong,
}

/// Puts lines together.
#[derive(Clone, Copy, Debug)]
pub struct Lines {
    line: [u8; MOST],
    length: usize,
}

impl Default for Lines {
    fn default() -> Self {
        Self::new()
    }
}

impl Lines {
    /// At the start of a line.
    pub const fn new() -> Self {
        Self {
            line: [0; MOST],
            length: 0,
        }
    }

    /// The next byte.
    pub fn byte(&mut self, byte: u8) -> Typed {
        if !matches!(byte, b'\r' | b'\n' | b' '..=b'~') {
            self.length = 0;
            return Typed::Nothing;
        }
        if !matches!(byte, b'\r' | b'\n') {
            if let Some(place) = self.line.get_mut(self.length) {
                *place = byte;
            }
            self.length = self.length.saturating_add(1);
            return Typed::Nothing;
        }
        let length = core::mem::take(&mut self.length);
        let line = &self.line[..length.min(MOST)];
        if !line.starts_with(b"AT") {
            return Typed::Nothing;
        }
        if length > MOST {
            return Typed::TooLong;
        }
        let known = COMMANDS.iter().find(|(text, _, _)| text.as_bytes() == line);
        known.map_or(Typed::Unknown, |(_, command, _)| Typed::Command(*command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn typed(text: &[u8]) -> Vec<Typed> {
        let mut lines = Lines::new();
        text.iter()
            .map(|&byte| lines.byte(byte))
            .filter(|typed| *typed != Typed::Nothing)
            .collect()
    }

    #[test]
    fn every_command_is_known_with_each_ending() {
        for (text, command, help) in COMMANDS {
            for ending in ["\r", "\n", "\r\n"] {
                let line = std::format!("{text}{ending}");
                assert_eq!(typed(line.as_bytes()), [Typed::Command(command)]);
            }
            assert!(text.len() <= MOST && !help.is_empty());
        }
    }

    #[test]
    fn lower_case_and_other_commands_are_unknown() {
        for line in [
            &b"AT+lock=1\n"[..],
            b"AT+LOCK\n",
            b"AT+LOCK=2\r\n",
            b"AT+UPDATE \n",
            b"ATZ\n",
        ] {
            assert_eq!(typed(line), [Typed::Unknown]);
        }
    }

    #[test]
    fn what_does_not_begin_with_at_is_somebody_elses() {
        assert_eq!(typed(b"\r\n\n$GPRMC,1\r\nat+lock=1\n XAT+LOCK=1\n"), []);
        assert_eq!(typed(&[b'x'; 1000]), []);
    }

    #[test]
    fn what_a_cancelled_sender_leaves_does_not_hide_the_next_command() {
        assert_eq!(
            typed(b"\x18\x18\x18\x08\x08\x08AT+LOCK?\r"),
            [Typed::Command(Command::IsLocked)]
        );
        assert_eq!(
            typed(b"\x01\x02garbage\xFFAT+LOCK?\r"),
            [Typed::Command(Command::IsLocked)]
        );
    }

    #[test]
    fn a_long_line_is_told_and_the_next_one_works() {
        let mut text = b"AT+".to_vec();
        text.extend([b'A'; 5000]);
        text.extend(b"\r\nAT+LOCK?\r\n");
        assert_eq!(
            typed(&text),
            [Typed::TooLong, Typed::Command(Command::IsLocked)]
        );
    }

    /// What lines complete, worked out from whole lines.
    fn expected(text: &[u8]) -> Vec<Typed> {
        let lines = text.split_inclusive(|byte| matches!(byte, b'\r' | b'\n'));
        let ended = lines.filter_map(|line| line.strip_suffix(b"\r").or(line.strip_suffix(b"\n")));
        ended
            .filter_map(|line| {
                let begun = line.iter().rposition(|byte| !(b' '..=b'~').contains(byte));
                let line = &line[begun.map_or(0, |at| at + 1)..];
                let known = COMMANDS.iter().find(|entry| entry.0.as_bytes() == line);
                match known {
                    _ if !line.starts_with(b"AT") => None,
                    _ if line.len() > 48 => Some(Typed::TooLong),
                    Some(entry) => Some(Typed::Command(entry.1)),
                    None => Some(Typed::Unknown),
                }
            })
            .collect()
    }

    #[test]
    fn a_million_mutated_lines_are_answered_once_each_and_nothing_else() {
        let mut state = 1u32;
        let mut next = move |below: usize| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as usize % below
        };
        let (mut known, mut refused) = (0, 0);
        for _ in 0..1_000_000 {
            let mut line = COMMANDS[next(COMMANDS.len())].0.as_bytes().to_vec();
            for _ in 0..next(4) {
                let at = next(line.len() + 1);
                match next(4) {
                    0 => line.insert(at, next(256) as u8),
                    1 => line.insert(at, b" ATR+=?01\r\n"[next(11)]),
                    2 if at < line.len() => drop(line.remove(at)),
                    _ if at < line.len() => line[at] ^= 1 << next(8),
                    _ => line.extend([b'A'; 60]),
                }
            }
            line.extend_from_slice([&b"\r"[..], b"\n", b"\r\n"][next(3)]);
            let found = typed(&line);
            assert_eq!(found, expected(&line), "{line:?}");
            let is_known = |typed: &&Typed| matches!(typed, Typed::Command(_));
            known += found.iter().filter(is_known).count();
            refused += found.len() - found.iter().filter(is_known).count();
        }
        assert!(known > 300_000 && refused > 300_000, "{known} {refused}");
    }
}
