//! Dialogues with the device as text files, replayed byte for byte: `tests/transcripts/*.txt`.
//!
//! ```text
//!   # a comment
//!   USB<< AT+PROTOCOL?                      typed on CONSOLE, ended by \r\n
//!   USB>> +PROTOCOL=CONSOLE,NONE            what it says, this line and no other, ended by \r\n
//!   UART<< at+config?\n                     another ending, where the line names one: \n, \r, or \ for none
//!   UART<< \x1a1C\                          bytes by their codes
//!   -- wait 1000 ms                         time passes
//!   -- pin low, -- pin released             BOOT/CONFIG
//!   -- pin 18 is low                        a pin of the chip, low or high
//!   -- uart is at 921600                    COMMS_UART's rate, within its divisor's step
//!   -- power cut                            off and on again, up to the open console
//!   -- starts                               waits for a start to be over, up to the open console
//!   -- off and on                           the same without waiting: BOOTLOADER has its window
//!   -- restarts                             waits for the next reset alone
//!   -- runs                                 waits until BOOTLOADER has been left, up to the open console
//!   -- on adsbee_1090_e                     the board, where it is not the usual one
//! ```
//! `{…}` in an expected line stands for anything within the line; `{lines}` alone for any number of lines. Each block of sends is followed by what both ports say until they are silent;
//! between the ports the order does not matter, within one it does. What is not expected is a failure.

use std::fmt::Write;
use twin::board::Board;
use twin::fault::Fault;

/// Twin time a block may take until all that is expected has come, ms.
const PATIENCE_MS: u64 = 1_500;
/// Twin time after it in which nothing more may come, ms.
const SILENCE_MS: u64 = 15;
/// Time off in a power cut, ms.
const OFF_MS: u64 = 300;

/// A port of the device.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Port {
    Usb,
    Uart,
}

enum Line {
    Send(Port, Vec<u8>),
    Expect(Port, String),
    Do(String),
}

fn parse(text: &str) -> Result<Vec<(usize, Line)>, String> {
    let mut lines = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let (mark, rest) = line.split_once(' ').unwrap_or((line, ""));
        let parsed = match mark {
            "" | "#" => continue,
            "USB<<" => Line::Send(Port::Usb, bytes(rest)),
            "UART<<" => Line::Send(Port::Uart, bytes(rest)),
            "USB>>" => Line::Expect(Port::Usb, rest.to_string()),
            "UART>>" => Line::Expect(Port::Uart, rest.to_string()),
            "--" => Line::Do(rest.to_string()),
            _ => {
                return Err(format!(
                    "line {number}: {line:?} is no line of a transcript"
                ));
            }
        };
        lines.push((number, parsed));
    }
    Ok(lines)
}

/// The bytes of a typed line, with its ending.
fn bytes(text: &str) -> Vec<u8> {
    let (text, ending): (&str, &[u8]) = if let Some(text) = text.strip_suffix("\\r\\n") {
        (text, b"\r\n")
    } else if let Some(text) = text.strip_suffix("\\n") {
        (text, b"\n")
    } else if let Some(text) = text.strip_suffix("\\r") {
        (text, b"\r")
    } else if let Some(text) = text.strip_suffix('\\') {
        (text, b"")
    } else {
        (text, b"\r\n")
    };
    let mut pieces = text.split("\\x");
    let mut made = pieces.next().unwrap_or("").as_bytes().to_vec();
    for piece in pieces {
        let (code, rest) = piece.split_at(2);
        made.push(u8::from_str_radix(code, 16).expect("two hexadecimal digits behind \\x"));
        made.extend(rest.as_bytes());
    }
    made.extend(ending);
    made
}

/// Replays a transcript; `Err` tells the line and what was said instead.
pub fn replay(board: &mut Board, text: &str) -> Result<(), String> {
    let lines = parse(text)?;
    let mut lines = lines.iter().peekable();
    let mut heard = [String::new(), String::new()];
    while let Some((number, line)) = lines.next() {
        match line {
            Line::Send(Port::Usb, bytes) => board.console_write(bytes),
            Line::Send(Port::Uart, bytes) => board.comms_write(bytes),
            Line::Do(what) => act(board, what).map_err(|why| format!("line {number}: {why}"))?,
            Line::Expect(..) => return Err(format!("line {number}: expected behind nothing")),
        }
        let mut expected = [Vec::new(), Vec::new()];
        while let Some((_, Line::Expect(port, line))) = lines.peek() {
            expected[*port as usize].push(line.as_str());
            lines.next();
        }
        // Several sends in a row are one block.
        let nothing = expected.iter().all(Vec::is_empty);
        if let (Line::Send(..), Some((_, Line::Send(..))), true) = (line, lines.peek(), nothing) {
            continue;
        }
        hear(board, &expected, &mut heard)?;
        for (port, name) in ["USB", "UART"].into_iter().enumerate() {
            let said = std::mem::take(&mut heard[port]);
            compare(name, &expected[port], &said)
                .map_err(|why| format!("behind line {number}: {why}"))?;
        }
    }
    Ok(())
}

/// Runs until as many lines have come as are expected, and a silence after them.
fn hear(
    board: &mut Board,
    expected: &[Vec<&str>; 2],
    heard: &mut [String; 2],
) -> Result<(), String> {
    let mut quiet_ms = 0;
    for _ in 0..PATIENCE_MS {
        board.run_ms(1).map_err(|error| error.to_string())?;
        let said = [board.console_read(), board.comms_read()];
        let moved = said.iter().any(|said| !said.is_empty());
        for (heard, said) in heard.iter_mut().zip(said) {
            // Latin-1: every byte is shown.
            heard.extend(said.iter().map(|&byte| char::from(byte)));
        }
        let all = (0..2).all(|port| heard[port].matches('\n').count() >= expected[port].len());
        quiet_ms = if all && !moved { quiet_ms + 1 } else { 0 };
        if quiet_ms >= SILENCE_MS {
            break;
        }
    }
    Ok(())
}

fn compare(port: &str, expected: &[&str], said: &str) -> Result<(), String> {
    let lines: Vec<&str> = said.split_inclusive('\n').collect();
    if all_fit(&lines, expected) {
        return Ok(());
    }
    let mut message = format!("{port} said\n");
    for line in &lines {
        let _ = writeln!(message, "  {line:?}");
    }
    let _ = writeln!(message, "instead of");
    for line in expected {
        let _ = writeln!(message, "  {line:?}");
    }
    Err(message)
}

/// Whether lines with their ends are the expected ones, among which `{lines}` stands for any number.
fn all_fit(lines: &[&str], expected: &[&str]) -> bool {
    match expected {
        [] => lines.is_empty(),
        ["{lines}", expected @ ..] => {
            (0..=lines.len()).any(|some| all_fit(&lines[some..], expected))
        }
        [first, expected @ ..] => lines.split_first().is_some_and(|(line, lines)| {
            let line = line.strip_suffix("\r\n");
            line.is_some_and(|line| fits(line, first)) && all_fit(lines, expected)
        }),
    }
}

/// The board that a transcript names.
pub fn board_of(text: &str) -> Option<&str> {
    text.lines().find_map(|line| line.strip_prefix("-- on "))
}

/// Where a line was typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Where {
    /// RUN, on CONSOLE.
    Run,
    /// CONFIGURATION, on either port.
    Configuration,
}

/// The commands that a transcript types, without `AT+`, each with where: as far as the device says in which state it is.
pub fn typed(text: &str) -> Vec<(Where, String)> {
    let mut state = Some(Where::Run);
    let mut found = Vec::new();
    for (_, line) in parse(text).expect("a transcript") {
        match line {
            Line::Send(port, bytes) => {
                let line = String::from_utf8_lossy(&bytes).into_owned();
                let is_known = state == Some(Where::Configuration) || port == Port::Usb;
                if let (Some(state), true, Some(line)) =
                    (state, is_known, line.trim_end().strip_prefix("AT+"))
                {
                    found.push((state, line.to_owned()));
                }
            }
            Line::Expect(_, line) => match line.as_str() {
                "AT+RUN_START" => state = Some(Where::Run),
                "AT+CONFIG_START" => state = Some(Where::Configuration),
                "AT+BOOTLOADER_START" => state = None,
                _ => {}
            },
            Line::Do(_) => {}
        }
    }
    found
}

/// Whether a line is the expected one, whose `{…}` stand for anything.
fn fits(line: &str, expected: &str) -> bool {
    let Some((before, rest)) = expected.split_once('{') else {
        return line == expected;
    };
    let Some((_, after)) = rest.split_once('}') else {
        return line == expected;
    };
    line.strip_prefix(before).is_some_and(|line| {
        (0..=line.len()).any(|at| line.is_char_boundary(at) && fits(&line[at..], after))
    })
}

fn act(board: &mut Board, what: &str) -> Result<(), String> {
    let words: Vec<&str> = what.split_whitespace().collect();
    let pin = board.kind.boot_config;
    let resets = board.chip.resets.len();
    let done = match words[..] {
        ["wait", ms, "ms"] => {
            let ms = ms.parse().map_err(|_| format!("{ms} ms"))?;
            board.run_ms(ms)
        }
        ["pin", "low"] => {
            board.chip.bus.pins.drive(pin, false);
            Ok(())
        }
        ["pin", "released"] => {
            board.chip.bus.pins.release(pin);
            Ok(())
        }
        ["pin", number, "is", level] => {
            let number: usize = number.parse().map_err(|_| format!("pin {number}"))?;
            if board.chip.bus.pins.level(number as u32) != (level == "high") {
                return Err(format!("pin {number} is not {level}"));
            }
            Ok(())
        }
        ["uart", "is", "at", baud] => {
            let set: f64 = baud.parse().map_err(|_| format!("{baud} baud"))?;
            let actual = board.chip.bus.uart[board.kind.comms_uart].baud();
            if (actual / set - 1.0).abs() > 0.005 {
                return Err(format!("COMMS_UART is at {actual:.0}, not {baud}"));
            }
            Ok(())
        }
        ["power", "cut"] => board
            .carry_out(Fault::PowerCut { off_ms: OFF_MS })
            .and_then(|()| start(board, resets)),
        ["starts"] => start(board, resets),
        ["off", "and", "on"] => board.carry_out(Fault::PowerCut { off_ms: OFF_MS }),
        ["restarts"] => board
            .run_until(1, |board| board.chip.resets.len() > resets)
            .map(|_| ()),
        ["runs"] => board
            .wait_for_capture()
            .and_then(|()| board.wait_for_console()),
        ["on", name] if name == board.kind.name => Ok(()),
        _ => return Err(format!("{what:?} is nothing that can be done")),
    };
    done.map_err(|error| error.to_string())
}

/// Through the bootloader up to the open console; what the bootloader said is taken away. Two resets from now: into the bootloader, and from it.
fn start(board: &mut Board, resets: usize) -> Result<(), twin::board::Error> {
    board.run_until(6, |board| board.chip.resets.len() >= resets + 2)?;
    board.comms_read();
    board.console_read();
    board.wait_for_capture()?;
    board.wait_for_console()
}
