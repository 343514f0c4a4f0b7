//! An update as a person does it: `AT+UPDATE` typed into the bootloader of the shipped image in the twin, the package sent by lrzsz's `sb -k` over a
//! pseudo-terminal, on both ports, clean and with bit errors; what is refused, and what a stalled transfer leaves.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::OptionalActions;

use twin::board::Board;

/// No transfer may take longer than this of the test's own time.
const PATIENCE: Duration = Duration::from_secs(240);
/// Emulated time between two looks at the sender's pipe.
const STEP_MS: u64 = 2;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Port {
    Comms,
    Console,
}

impl Port {
    fn write(self, board: &mut Board, bytes: &[u8]) {
        match self {
            Port::Comms => board.comms_write(bytes),
            Port::Console => board.console_write(bytes),
        }
    }

    fn read(self, board: &mut Board) -> Vec<u8> {
        match self {
            Port::Comms => board.comms_read(),
            Port::Console => board.console_read(),
        }
    }
}

fn package() -> std::path::PathBuf {
    let path = tests::root().join("target/fw/squitter-adsbee_1090.sqt");
    assert!(
        path.exists(),
        "{} is missing; `cargo xtask fw` makes it",
        path.display()
    );
    path
}

/// A board in its bootloader's window, half a second after power-on.
fn in_window() -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.run_ms(500).expect("the chip runs");
    board
}

/// Types a line; what is answered within `ms`.
fn ask(board: &mut Board, port: Port, line: &str, ms: u64) -> String {
    port.read(board);
    port.write(board, format!("{line}\r\n").as_bytes());
    board.run_ms(ms).expect("the chip runs");
    String::from_utf8_lossy(&port.read(board)).into_owned()
}

/// `sb -k` with a terminal as its standard input and output, as in `sb -k FILE </dev/ttyACM0 >/dev/ttyACM0`.
struct Sender {
    child: Child,
    master: File,
    /// Held open, so that what the sender said last can be read after its end.
    _terminal: File,
}

impl Sender {
    fn start(path: &std::path::Path) -> Self {
        let (master, terminal) = terminal().expect("a pseudo-terminal");
        let end = || terminal.try_clone().expect("a descriptor");
        let child = Command::new("sb")
            .args(["-k", "-q"])
            .arg(path)
            .stdin(end())
            .stdout(end())
            .spawn()
            .expect("`sb` is missing; install lrzsz");
        Self {
            child,
            master,
            _terminal: terminal,
        }
    }

    /// What it has sent since the last call.
    fn take(&mut self) -> Vec<u8> {
        let mut piece = [0; 4096];
        match self.master.read(&mut piece) {
            Ok(count) => piece[..count].to_vec(),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Vec::new(),
            Err(error) => panic!("the pseudo-terminal: {error}"),
        }
    }

    /// Answers it. A few bytes at a time: the terminal has room for them.
    fn give(&mut self, bytes: &[u8]) {
        self.master.write_all(bytes).expect("the terminal has room");
    }

    /// Moves bytes both ways until the sender ends; a bit of every `flip_every`-th byte is flipped on its way to the device. Says whether the
    /// sender was content.
    fn run(mut self, board: &mut Board, port: Port, flip_every: Option<usize>) -> bool {
        let start = Instant::now();
        let mut sent = 0;
        loop {
            assert!(start.elapsed() < PATIENCE, "{port:?}: {sent} bytes sent");
            let mut piece = self.take();
            for byte in &mut piece {
                sent += 1;
                if flip_every.is_some_and(|every| sent % every == 0) {
                    *byte ^= 0x20;
                }
            }
            port.write(board, &piece);
            board.run_ms(STEP_MS).expect("the chip runs");
            let reply = port.read(board);
            self.give(&reply);
            let idle = piece.is_empty() && reply.is_empty();
            if let Some(status) = self.child.try_wait().expect("the sender can be asked") {
                return status.success();
            }
            if idle {
                // The device's time passes faster than the sender thinks: let it catch up.
                std::thread::sleep(Duration::from_micros(500));
            }
        }
    }
}

/// A pseudo-terminal in raw mode: the side that is the line, which does not wait, and the terminal.
fn terminal() -> std::io::Result<(File, File)> {
    let master = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
    rustix::pty::grantpt(&master)?;
    rustix::pty::unlockpt(&master)?;
    let name = rustix::pty::ptsname(&master, Vec::new())?;
    let flags = OFlags::RDWR | OFlags::NOCTTY;
    let terminal = rustix::fs::open(name.as_c_str(), flags, Mode::empty())?;
    let mut termios = rustix::termios::tcgetattr(&terminal)?;
    termios.make_raw();
    rustix::termios::tcsetattr(&terminal, OptionalActions::Now, &termios)?;
    let flags = rustix::fs::fcntl_getfl(&master)?;
    rustix::fs::fcntl_setfl(&master, flags | OFlags::NONBLOCK)?;
    Ok((master.into(), terminal.into()))
}

/// Runs until the app captures; then the DEVICE line of `AT+STATS?`.
fn device_line(board: &mut Board) -> String {
    let captures = |board: &mut Board| board.chip.bus.pio[0].enabled_at[0] != 0;
    assert!(board.run_until(5, captures).expect("the chip runs"));
    board.wait_for_console().expect("the console opens");
    ask(board, Port::Console, "AT+PROTOCOL=CONSOLE,NONE", 50);
    let said = ask(board, Port::Console, "AT+STATS?", 50);
    let line = said.lines().find(|line| line.contains("=DEVICE,"));
    line.unwrap_or_else(|| panic!("no DEVICE in {said:?}"))
        .to_owned()
}

fn update(port: Port, flip_every: Option<usize>) {
    let mut board = in_window();
    let answer = ask(&mut board, port, "AT+UPDATE", 30);
    assert!(answer.starts_with("AT+OK\r\n"), "{port:?}: {answer:?}");
    let sent = Sender::start(&package()).run(&mut board, port, flip_every);
    assert!(sent, "{port:?}: the sender was not content");
    let line = device_line(&mut board);
    assert!(line.ends_with("slot=B,image=on_trial"), "{port:?}: {line}");
}

#[test]
fn sb_updates_the_device_over_usb() {
    update(Port::Console, None);
}

#[test]
fn sb_updates_the_device_over_usb_with_a_bit_error_every_5003_bytes() {
    update(Port::Console, Some(5003));
}

#[test]
fn sb_updates_the_device_over_its_uart() {
    update(Port::Comms, None);
}

#[test]
fn sb_updates_the_device_over_its_uart_with_a_bit_error_every_5003_bytes() {
    update(Port::Comms, Some(5003));
}

#[test]
fn the_app_goes_to_the_bootloader_when_asked_and_stays_there() {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    device_line(&mut board);
    let answer = ask(&mut board, Port::Console, "AT+REBOOT_BOOTLOADER", 20);
    assert_eq!(answer, "OK\r\n");
    board.run_ms(5_000).expect("the chip runs");
    assert_eq!(
        ask(&mut board, Port::Console, "AT+LOCK?", 20),
        "AT+LOCK=1\r\n"
    );
    assert_eq!(
        board.chip.bus.pio[0].enabled_at[0], 0,
        "the app was started"
    );
}

#[test]
fn the_bootloader_answers_at_once_and_its_lock_holds() {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.run_ms(100).expect("the chip runs");
    let greeting = String::from_utf8_lossy(&board.comms_read()).into_owned();
    assert_eq!(greeting, "AT+BOOTLOADER_START\r\n");
    assert_eq!(
        ask(&mut board, Port::Comms, "AT+BOOT?", 20),
        "AT+BOOT=1\r\n"
    );
    assert_eq!(
        ask(&mut board, Port::Comms, "AT+LOCK?", 20),
        "AT+LOCK=0\r\n"
    );
    assert_eq!(ask(&mut board, Port::Comms, "AT+LOCK=1", 20), "AT+OK\r\n");
    board.run_ms(61_000).expect("the chip runs");
    assert_eq!(
        ask(&mut board, Port::Console, "AT+LOCK?", 20),
        "AT+LOCK=1\r\n"
    );
    let info = ask(&mut board, Port::Console, "AT+INFO", 100);
    assert!(
        info.contains("Slot A: ") && info.contains("Slot B: no image\r\n"),
        "{info:?}"
    );
    let wrong = ask(&mut board, Port::Console, "at+lock=0", 20);
    assert_eq!(wrong, "");
    assert_eq!(
        board.chip.bus.pio[0].enabled_at[0], 0,
        "the app was started"
    );
    assert_eq!(ask(&mut board, Port::Console, "AT+LOCK=0", 20), "AT+OK\r\n");
    assert!(device_line(&mut board).contains("slot=A"));
}

#[test]
fn a_foreign_package_is_refused_by_name_and_a_good_one_still_works() {
    let mut board = in_window();
    let mut foreign = std::fs::read(package()).expect("the package");
    // The header names another key; its own CRC is made to fit.
    for header in [8, 264] {
        foreign[header + 76] ^= 1;
        let crc = boot_contract::crc32(&foreign[header..header + 188]);
        foreign[header + 188..header + 192].copy_from_slice(&crc.to_le_bytes());
    }
    let path = std::env::temp_dir().join(format!("squitter-foreign-{}", std::process::id()));
    std::fs::write(&path, foreign).expect("a file for the test");
    ask(&mut board, Port::Console, "AT+UPDATE", 30);
    let sent = Sender::start(&path).run(&mut board, Port::Console, None);
    let _ = std::fs::remove_file(&path);
    assert!(!sent, "the sender was content");
    // What was said while the sender was ending is gone with its pipe; the lock holds, and nothing was written.
    board.run_ms(100).expect("the chip runs");
    let info = ask(&mut board, Port::Console, "AT+INFO", 900);
    assert!(info.contains("Slot B: no image\r\n"), "{info:?}");
    ask(&mut board, Port::Console, "AT+UPDATE", 30);
    assert!(Sender::start(&package()).run(&mut board, Port::Console, None));
    assert!(device_line(&mut board).ends_with("slot=B,image=on_trial"));
}

#[test]
fn a_transfer_that_nobody_goes_on_with_leaves_a_prompt_within_ten_seconds() {
    let mut board = in_window();
    ask(&mut board, Port::Console, "AT+UPDATE", 30);
    let mut sender = Sender::start(&package());
    // The sender is killed after some blocks.
    let mut sent = 0;
    let start = Instant::now();
    while sent < 20_000 {
        assert!(start.elapsed() < PATIENCE, "{sent}");
        let piece = sender.take();
        sent += piece.len();
        board.console_write(&piece);
        board.run_ms(STEP_MS).expect("the chip runs");
        sender.give(&board.console_read());
    }
    sender.child.kill().expect("the sender can be killed");
    let _ = sender.child.wait();
    board.run_ms(10_000).expect("the chip runs");
    let said = String::from_utf8_lossy(&board.console_read()).into_owned();
    assert!(said.contains("AT+ERROR (transfer stalled)\r\n"), "{said:?}");
    assert_eq!(
        ask(&mut board, Port::Console, "AT+LOCK?", 20),
        "AT+LOCK=1\r\n"
    );
}
