//! The bootloader's times and its stack, measured on the shipped image in the twin: requirement by requirement, with its limits.

use twin::board::Board;

use crate::power_cuts::in_twin::Console;

/// How long a lock is watched, ms: longer than the minute it must hold.
const LOCK_MS: u64 = 65_000;
/// A figure and what it may be.
#[derive(Clone, Debug)]
pub struct Row {
    pub what: &'static str,
    pub measured: f64,
    pub unit: &'static str,
    /// Least and most.
    pub limits: (f64, f64),
}

impl Row {
    /// Within its limits?
    pub fn holds(&self) -> bool {
        (self.limits.0..=self.limits.1).contains(&self.measured)
    }
}

fn board() -> Board {
    Board::power_on(&crate::image()).expect("the image is flashed")
}

/// Milliseconds from now to the chip's next reset.
fn to_reset(board: &mut Board) -> f64 {
    let (began, resets) = (board.seconds(), board.chip.resets.len());
    let reset = |board: &mut Board| board.chip.resets.len() > resets;
    assert!(board.run_until(10, reset).expect("the chip runs"));
    (board.seconds() - began) * 1e3
}

/// Milliseconds from power-on to the first reply on a port, a command waiting there from the start.
fn to_first_reply(write: fn(&mut Board, &[u8]), read: fn(&mut Board) -> Vec<u8>) -> f64 {
    let mut board = board();
    let mut said = Vec::new();
    for ms in 0..2_000 {
        // Whoever calls a device that starts calls more than once.
        if ms % 10 == 0 {
            write(&mut board, b"AT\r\n");
        }
        board.run_ms(1).expect("the chip runs");
        said.extend(read(&mut board));
        if said.windows(5).any(|bytes| bytes == b"AT+OK") {
            return board.seconds() * 1e3;
        }
    }
    f64::INFINITY
}

/// Milliseconds from the moment the host has configured the device and opened its port to the first reply there.
fn to_first_usb_reply() -> f64 {
    let mut board = board();
    let open = |board: &mut Board| board.chip.bus.usb_host.open;
    assert!(board.run_until(2, open).expect("the chip runs"));
    let began = board.seconds();
    board.console_write(b"AT\r\n");
    let answered = |board: &mut Board| {
        let said: Vec<u8> = board
            .chip
            .bus
            .usb_host
            .from_device
            .iter()
            .copied()
            .collect();
        said.windows(5).any(|bytes| bytes == b"AT+OK")
    };
    assert!(board.run_until(2, answered).expect("the chip runs"));
    (board.seconds() - began) * 1e3
}

/// Whether a locked device is still there after [`LOCK_MS`]; the milliseconds, or infinity.
fn lock_holds() -> f64 {
    let mut board = board();
    board.run_ms(500).expect("the chip runs");
    board.comms_write(b"AT+LOCK=1\r\n");
    board.run_ms(LOCK_MS).expect("the chip runs");
    if board.chip.resets.len() == 1 {
        LOCK_MS as f64
    } else {
        0.0
    }
}

/// Bytes of stack in use at most, from power-on through a whole update over YMODEM to the hand-over.
fn stack_of_an_update() -> f64 {
    let script = crate::power_cuts::in_twin::Script::new();
    let mut board = board();
    board.run_ms(500).expect("the chip runs");
    let resets = board.chip.resets.len();
    board.console_write(b"AT+UPDATE\r\n");
    board.run_ms(50).expect("the chip runs");
    let mut console = Console(board);
    release::ymodem::send(&mut console, "new.sqt", script.new_package(), &mut |_| {})
        .expect("it is taken");
    let mut board = console.0;
    let mut deepest = 0;
    while board.chip.resets.len() == resets {
        deepest = deepest.max(board.chip.stack(0).used());
        board.run_ms(1).expect("the chip runs");
    }
    f64::from(deepest)
}

/// All of them.
pub fn rows() -> Vec<Row> {
    let row = |what, measured, unit, limits| Row {
        what,
        measured,
        unit,
        limits,
    };
    let mut started = board();
    let window = to_reset(&mut started);
    let app = |board: &mut Board| board.chip.bus.pio[0].enabled_at[0] != 0;
    assert!(started.run_until(2, app).expect("the chip runs"));
    started.wait_for_console().expect("the console opens");
    started.console_write(b"AT+REBOOT\r\n");
    to_reset(&mut started);
    let again = to_reset(&mut started);
    let three = (2950.0, 3050.0);
    vec![
        row(
            "window after power-on, slot A verified inside it",
            window,
            "ms",
            three,
        ),
        row("window after AT+REBOOT", again, "ms", three),
        row(
            "lock held for",
            lock_holds(),
            "ms",
            (60_000.0, f64::INFINITY),
        ),
        row(
            "first AT reply on COMMS_UART after power-on",
            to_first_reply(|b, bytes| b.comms_write(bytes), Board::comms_read),
            "ms",
            (0.0, 200.0),
        ),
        row(
            "first AT reply on CONSOLE after the host opened it",
            to_first_usb_reply(),
            "ms",
            (0.0, 200.0),
        ),
        row(
            "stack through a whole update",
            stack_of_an_update(),
            "bytes",
            (1.0, 16_384.0),
        ),
    ]
}
