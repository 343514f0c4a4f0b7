//! The bootloader's times and its stack, measured on the shipped image in the twin: requirement by requirement, with its limits.

use twin::board::Board;

use crate::power_cuts::in_twin::{Console, Script};

/// How long a lock is watched, ms: longer than the minute it must hold.
const LOCK_MS: u64 = 65_000;
/// Somebody who calls a device that starts calls this often, ms.
const CALL_EVERY_MS: u64 = 10;
/// What a measurement gives when the thing did not happen.
const NEVER: f64 = f64::INFINITY;
/// Least and most of the window, ms.
const WINDOW: (f64, f64) = (2_950.0, 3_050.0);
/// Of a reply.
const REPLY: (f64, f64) = (0.0, 200.0);

/// A figure, how it is measured and what it may be.
pub struct Measurement {
    pub what: &'static str,
    pub unit: &'static str,
    /// Least and most.
    pub limits: (f64, f64),
    measure: fn() -> f64,
}

/// All of them.
pub const ALL: [Measurement; 8] = [
    Measurement {
        what: "window after power-on, slot A verified inside it",
        unit: "ms",
        limits: WINDOW,
        measure: window_after_power_on,
    },
    Measurement {
        what: "window with an update of 512 KiB in slot B too",
        unit: "ms",
        limits: WINDOW,
        measure: window_with_two_images,
    },
    Measurement {
        what: "window after AT+REBOOT",
        unit: "ms",
        limits: WINDOW,
        measure: window_after_reboot,
    },
    Measurement {
        what: "lock held for",
        unit: "ms",
        limits: (60_000.0, NEVER),
        measure: lock_holds,
    },
    Measurement {
        what: "first AT reply on COMMS_UART after power-on",
        unit: "ms",
        limits: REPLY,
        measure: first_comms_reply,
    },
    Measurement {
        what: "first AT reply on CONSOLE after its enumeration",
        unit: "ms",
        limits: REPLY,
        measure: first_console_reply,
    },
    Measurement {
        what: "slowest AT reply while the slots are verified",
        unit: "ms",
        limits: (0.0, 250.0),
        measure: slowest_reply,
    },
    Measurement {
        what: "stack through a whole update",
        unit: "bytes",
        limits: (1.0, 16_384.0),
        measure: stack_of_an_update,
    },
];

/// A measurement's outcome.
pub struct Row {
    pub what: &'static str,
    pub unit: &'static str,
    pub limits: (f64, f64),
    pub measured: f64,
}

impl Measurement {
    /// Does it.
    pub fn row(&self) -> Row {
        Row {
            what: self.what,
            unit: self.unit,
            limits: self.limits,
            measured: (self.measure)(),
        }
    }
}

impl Row {
    /// Within its limits?
    pub fn holds(&self) -> bool {
        (self.limits.0..=self.limits.1).contains(&self.measured)
    }
}

fn power_on() -> Board {
    Board::power_on(&crate::image()).expect("the image is flashed")
}

/// Runs until `done`, at most `seconds`; the milliseconds it took.
fn until(board: &mut Board, seconds: u64, done: impl FnMut(&mut Board) -> bool) -> f64 {
    let began = board.seconds();
    if board.run_until(seconds, done).expect("the chip runs") {
        (board.seconds() - began) * 1e3
    } else {
        NEVER
    }
}

/// Milliseconds from now to the chip's next reset.
fn to_reset(board: &mut Board) -> f64 {
    let resets = board.chip.resets.len();
    until(board, 10, |board| board.chip.resets.len() > resets)
}

fn window_after_power_on() -> f64 {
    to_reset(&mut power_on())
}

/// Two signatures, two hashes and the record of a trial.
fn window_with_two_images() -> f64 {
    to_reset(&mut Board::with_flash(
        Script::new().flash_with_update(512 << 10),
    ))
}

fn window_after_reboot() -> f64 {
    let mut board = power_on();
    board.wait_for_capture().expect("the app captures");
    board.wait_for_console().expect("the console opens");
    board.console_write(b"AT+REBOOT\r\n");
    to_reset(&mut board);
    to_reset(&mut board)
}

/// Whether a locked device is still there after [`LOCK_MS`]: the milliseconds until it left.
fn lock_holds() -> f64 {
    let mut board = power_on();
    board.run_ms(500).expect("the chip runs");
    board.comms_write(b"AT+LOCK=1\r\n");
    let resets = board.chip.resets.len();
    let left = |board: &mut Board| board.chip.resets.len() > resets;
    match until(&mut board, LOCK_MS / 1000, left) {
        NEVER => LOCK_MS as f64,
        ms => ms,
    }
}

/// Milliseconds to the reply, a command being sent again and again.
fn to_reply(
    board: &mut Board,
    write: fn(&mut Board, &[u8]),
    read: fn(&mut Board) -> Vec<u8>,
) -> f64 {
    let (mut said, mut ms) = (Vec::new(), 0);
    until(board, 2, |board| {
        if ms % CALL_EVERY_MS == 0 {
            write(board, b"AT\r\n");
        }
        ms += 1;
        said.extend(read(board));
        said.windows(5).any(|bytes| bytes == b"AT+OK")
    })
}

fn first_comms_reply() -> f64 {
    to_reply(
        &mut power_on(),
        |board, bytes| board.comms_write(bytes),
        Board::comms_read,
    )
}

/// From the moment the host has configured the device and opened its port.
fn first_console_reply() -> f64 {
    let mut board = power_on();
    let opened = board.run_until(2, |board| board.chip.bus.usb_host.open);
    assert!(opened.expect("the chip runs"), "the host opens the port");
    to_reply(
        &mut board,
        |board, bytes| board.console_write(bytes),
        Board::console_read,
    )
}

/// From half a second on until the reset, one call after the other: the verification is cut into slices.
fn slowest_reply() -> f64 {
    let mut board = power_on();
    let resets = board.chip.resets.len();
    let mut slowest: f64 = 0.0;
    while board.chip.resets.len() == resets && slowest.is_finite() {
        board.comms_write(b"AT\r\n");
        let mut said = Vec::new();
        let ms = until(&mut board, 2, |board| {
            said.extend(board.comms_read());
            said.ends_with(b"AT+OK\r\n") || board.chip.resets.len() > resets
        });
        slowest = slowest.max(ms);
    }
    slowest
}

/// Bytes of stack in use at most, from power-on through a whole update over YMODEM to the hand-over.
fn stack_of_an_update() -> f64 {
    let script = Script::new();
    let mut board = power_on();
    board.run_ms(500).expect("the chip runs");
    board.console_write(b"AT+UPDATE\r\n");
    board.run_ms(50).expect("the chip runs");
    let mut console = Console(board);
    release::ymodem::send(&mut console, "new.sqt", script.new_package(), &mut |_| {})
        .expect("it is taken");
    let mut board = console.0;
    let resets = board.chip.resets.len();
    let mut deepest = 0;
    // The watch begins anew at the reset.
    let handed_over = until(&mut board, 2, |board| {
        if board.chip.resets.len() > resets {
            return true;
        }
        deepest = deepest.max(board.chip.stack(0).used());
        false
    });
    assert!(handed_over.is_finite(), "the new image is started");
    f64::from(deepest)
}
