//! The conversation with a device: what state it is in, how it gets into its bootloader, what it says of itself.
//!
//! | state | told by | the way to the bootloader |
//! |---|---|---|
//! | BOOTLOADER | `AT+BOOT?` is answered `AT+BOOT=1` | `AT+LOCK=1` |
//! | RUN, on CONSOLE | … `+BOOT=0`, by older firmware `ERROR …` | `AT+REBOOT_BOOTLOADER` |
//! | CONFIGURATION | … `AT+BOOT=0` or `AT+ERROR (…)` | `AT+REBOOT_BOOTLOADER` |
//! | RUN, on COMMS_UART | … nothing | `AT+CONFIG=1`, then as in CONFIGURATION |
//!
//! Reports may stand between the answers, binary ones too: an answer is looked for by its words, wherever they stand.

use super::line::Line;

/// Rate of the bootloader and of CONFIGURATION, bits a second.
pub const FIXED_BAUD: u32 = 115_200;
/// Behind its answer a firmware takes 100 ms to restart, ms.
const RESTART_MS: u64 = 300;
/// What a start without stored settings says before `AT+RUN_START`.
const MISSING_SETTINGS: &str = "AT+ERROR (Settings missing, loaded default)\r\n";
/// How long an answer may take, ms: a line of a report may have to leave first.
const ANSWER_MS: u64 = 700;
/// How long `AT+CONFIG=1` may take: the last whole report leaves first.
const CONFIG_MS: u64 = 2_500;
/// How long an answer that verifies first may take, ms: two signatures and two images.
const VERIFIED_MS: u64 = 3_000;
/// Unanswered questions after which a device is taken for silent.
const SILENT_AFTER: u32 = 3;
/// What a receiver of YMODEM takes for the end, and a command line for the end of rubbish.
const CANCEL: &[u8] = &[0x18, 0x18, 0x18];

/// Where a device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    Bootloader,
    Run,
    Configuration,
    /// It says nothing, or nothing that is an answer.
    Silent,
}

/// What a device says of the firmware it runs or would run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Told {
    /// `0.1.0.0 (Nov 25 2026)`
    pub version: String,
    pub slot: Option<char>,
    pub confirmed: bool,
    /// The last crash, as it is told; empty if there was none.
    pub crash: String,
}

/// The conversation.
pub struct Talk<'l> {
    pub line: &'l mut dyn Line,
}

impl Talk<'_> {
    /// Sends a line; what comes until one of `wanted` stands in it with its line's end, or `ms` have passed.
    fn ask(&mut self, text: &str, wanted: &[&str], ms: u64) -> std::io::Result<String> {
        self.line.write(format!("\r{text}\r\n").as_bytes())?;
        self.listen(Vec::new(), wanted, ms)
    }

    /// What has come already, and what comes, likewise.
    pub fn listen(
        &mut self,
        mut heard: Vec<u8>,
        wanted: &[&str],
        ms: u64,
    ) -> std::io::Result<String> {
        let end = self.line.now_ms() + ms;
        loop {
            let left = end.saturating_sub(self.line.now_ms());
            heard.extend(self.line.read(left)?);
            // A firmware without stored settings says so when it starts: no answer to anything.
            let text = String::from_utf8_lossy(&heard).replace(MISSING_SETTINGS, "");
            let is_there =
                |words: &&str| text.find(words).is_some_and(|at| text[at..].contains('\n'));
            if left == 0 || wanted.iter().any(is_there) {
                return Ok(text);
            }
        }
    }

    /// Asks where it is. A transfer that somebody left behind is ended.
    pub fn state(&mut self) -> std::io::Result<State> {
        for _ in 0..SILENT_AFTER {
            self.line.write(CANCEL)?;
            let said = self.ask("AT+BOOT?", &["+BOOT="], ANSWER_MS)?;
            let state = state(&said);
            if state != State::Silent {
                return Ok(state);
            }
        }
        Ok(State::Silent)
    }

    /// Gets it into its bootloader, where it stays, within `patience_ms`. `run_baud` is the rate of a firmware that runs. Returns where it was.
    pub fn enter(&mut self, run_baud: u32, patience_ms: u64) -> std::io::Result<Option<State>> {
        let end = self.line.now_ms() + patience_ms;
        let mut first = None;
        while self.line.now_ms() < end {
            let state = self.state()?;
            first = first.or(Some(state).filter(|state| *state != State::Silent));
            match state {
                State::Bootloader => {
                    if self
                        .ask("AT+LOCK=1", &["AT+OK"], ANSWER_MS)?
                        .contains("AT+OK")
                    {
                        return Ok(first);
                    }
                }
                State::Run | State::Configuration => {
                    self.ask("AT+REBOOT_BOOTLOADER", &["OK"], ANSWER_MS)?;
                    self.wait(RESTART_MS)?;
                    self.line.set_baud(FIXED_BAUD)?;
                }
                State::Silent => {
                    self.configure(run_baud)?;
                    first = first.or(Some(State::Run));
                }
            }
        }
        Ok(None)
    }

    /// From RUN into CONFIGURATION, on a port that answers nothing else. Whether it went there.
    pub fn configure(&mut self, run_baud: u32) -> std::io::Result<bool> {
        self.line.set_baud(run_baud)?;
        self.ask("AT+CONFIG=1", &["AT+RUN_END"], CONFIG_MS)?;
        self.line.set_baud(FIXED_BAUD)?;
        Ok(self.state()? == State::Configuration)
    }

    /// Back into RUN.
    pub fn run(&mut self) -> std::io::Result<()> {
        self.ask("AT+CONFIG=0", &["AT+OK"], ANSWER_MS).map(|_| ())
    }

    /// `AT+INFO` of the firmware; `None` if it does not answer so.
    pub fn info(&mut self) -> std::io::Result<Option<Told>> {
        let said = self.ask("AT+INFO", &["Last crash: "], ANSWER_MS)?;
        Ok(told(&said))
    }

    /// `AT+INFO` of the bootloader: its lines.
    pub fn slots(&mut self) -> std::io::Result<Vec<String>> {
        let said = self.ask("AT+INFO", &["Security counter: "], VERIFIED_MS)?;
        let lines = said.lines().filter(|line| line.starts_with("Slot "));
        Ok(lines.map(str::to_owned).collect())
    }

    /// Makes the bootloader ready for a file. `Err` holds what it said instead.
    pub fn begin_update(&mut self) -> std::io::Result<Result<(), String>> {
        let said = self.ask("AT+UPDATE", &["AT+OK"], ANSWER_MS)?;
        Ok(if said.contains("AT+OK") {
            Ok(())
        } else {
            Err(said.trim().to_owned())
        })
    }

    /// Lets time pass; what comes meanwhile is nobody's.
    pub fn wait(&mut self, ms: u64) -> std::io::Result<()> {
        self.listen(Vec::new(), &[], ms).map(|_| ())
    }

    /// The bootloader's word after a transfer, part of which may have come already: `None` is `AT+OK`, else its reason; `Err` holds what else was heard.
    pub fn verdict(
        &mut self,
        heard: Vec<u8>,
        ms: u64,
    ) -> std::io::Result<Result<Option<String>, String>> {
        let said = self.listen(heard, &["AT+OK", "AT+ERROR ("], ms)?;
        Ok(if let Some(reason) = between(&said, "AT+ERROR (", ")") {
            Ok(Some(reason.to_owned()))
        } else if said.contains("AT+OK") {
            Ok(None)
        } else {
            Err(said.trim().to_owned())
        })
    }
}

/// What the answer to `AT+BOOT?` means.
fn state(said: &str) -> State {
    if said.contains("AT+BOOT=1") {
        State::Bootloader
    } else if said.contains("AT+BOOT=0") || said.contains("AT+ERROR (") {
        State::Configuration
    } else if said.contains("+BOOT=0") || said.contains("ERROR ") {
        State::Run
    } else {
        State::Silent
    }
}

/// What stands between two marks.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(from)?;
    rest.split_once(to).map(|(inner, _)| inner)
}

/// `Firmware: <version>, slot <letter>, <standing>`, and the crash.
fn told(said: &str) -> Option<Told> {
    let line = between(said, "Firmware: ", "\n")?.trim_end();
    let (version, rest) = line.split_once(", slot ")?;
    let crash = between(said, "Last crash: ", "\n").unwrap_or("").trim_end();
    Some(Told {
        version: version.to_owned(),
        slot: rest.chars().next(),
        confirmed: rest.ends_with(", confirmed"),
        crash: match crash {
            "none since power-on" => String::new(),
            crash => crash.to_owned(),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_state_is_told_by_the_dialect_of_the_answer() {
        for (said, expected) in [
            ("AT+BOOT=1\r\n", State::Bootloader),
            ("AT+ERROR (no image)\r\nAT+BOOT=1\r\n", State::Bootloader),
            ("AT+BOOT=0\r\n", State::Configuration),
            ("AT+ERROR (unknown command)\r\n", State::Configuration),
            ("#A:1,2\r\n+BOOT=0\r\n", State::Run),
            ("ERROR unknown command, AT+HELP lists them\r\n", State::Run),
            ("*8D4840D6202CC371C32CE0576098;\r\n", State::Silent),
        ] {
            assert_eq!(state(said), expected, "{said}");
        }
    }

    #[test]
    fn what_a_device_tells_is_found_among_its_reports() {
        let said = "#A:1,2\r\nDevice: adsbee_1090\r\nFirmware: 0.1.0.0 (Nov 25 2026), slot B, on trial\r\n\
                    #A:3,4\r\nLast crash: watchdog: core 1 stopped; firmware 0.1.0.0 (1 since power-on)\r\nOK\r\n";
        let told = told(said).unwrap();
        assert_eq!(told.version, "0.1.0.0 (Nov 25 2026)");
        assert_eq!((told.slot, told.confirmed), (Some('B'), false));
        assert!(told.crash.starts_with("watchdog: core 1"));
        assert_eq!(super::told("OK\r\n"), None);
    }
}
