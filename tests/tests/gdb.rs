//! A real GDB on the twin's remote port: the shipped image under `gdb-multiarch`, with the ELF file's names. Needs `gdb-multiarch` and fails
//! without it.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use twin::board::Board;
use twin::gdb::{End, serve};

const GDB: &str = "gdb-multiarch";

/// Emulated seconds after which a session that should have ended is given up.
fn not_for_ever(board: &mut Board) {
    assert!(board.seconds() < 10.0, "GDB lets the device run on and on");
}

/// Runs GDB with these commands against a board at power-on: what it printed, how its session ended, and the board.
fn session(commands: &[&str]) -> (String, End, Board) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("bound").port();
    let elf: PathBuf = tests::image().with_file_name("app.elf");
    let mut gdb = Command::new(GDB);
    gdb.args(["-nx", "-batch", "-ex", "set pagination off"])
        .args(["-ex", "set architecture armv6s-m"])
        .arg("-ex")
        .arg(format!("target remote 127.0.0.1:{port}"));
    for command in commands {
        gdb.args(["-ex", command]);
    }
    let gdb = gdb
        .arg(elf)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| {
            panic!("{GDB} does not start ({error}); install it: apt-get install {GDB}")
        });
    let mut board = Board::power_on(&tests::image()).expect("the image");
    let (stream, _) = listener.accept().expect("GDB connects");
    let end = serve(&mut board, stream, not_for_ever).expect("the session ends as it should");
    let output = gdb.wait_with_output().expect("GDB ends");
    let text = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    (text, end, board)
}

#[test]
fn gdb_stops_in_a_named_function_reads_and_steps() {
    let (text, end, mut board) = session(&[
        "break app::core1::run",
        "continue",
        "backtrace 1",
        "print/x $pc",
        "info threads",
        "print hal::dma_ring::BLOCK_RELOAD",
        "delete",
        "stepi",
        "print/x $pc",
        "thread 1",
        "set $before = $r7",
        "set var $r7 = 0x1234",
        "info registers r7",
        "set var $r7 = $before",
        "detach",
    ]);
    for expected in [
        "Breakpoint 1 at 0x2000",
        "Thread 2 hit Breakpoint 1, app::core1::run (slot=",
        "#0  app::core1::run",
        "Thread 1 (core 0)",
        "Thread 2 (core 1)",
        "0x1234",
    ] {
        assert!(text.contains(expected), "{expected:?} is not in:\n{text}");
    }
    // Two program counters, one instruction apart.
    let pc = |n: u32| {
        let line = text
            .lines()
            .find_map(|l| l.strip_prefix(&format!("${n} = 0x")));
        line.and_then(|hex| u32::from_str_radix(hex, 16).ok())
            .unwrap_or_else(|| panic!("no ${n} in:\n{text}"))
    };
    assert_eq!(pc(3) - pc(1), 2, "{text}");
    // The words a block has, as `hal` sets them.
    assert!(text.lines().any(|l| l.starts_with("$2 = ")), "{text}");
    assert_eq!(end, End::Detached);
    // Left alone, the device goes on as if nothing had been.
    board.wait_for_console().expect("the console opens");
}

#[test]
fn gdb_stops_behind_a_write_to_a_watched_variable() {
    let (text, _, _) = session(&[
        // The first word of SRAM: data of whichever image starts.
        "set language c",
        "watch *(unsigned int *)0x20000000",
        "continue",
        "kill",
    ]);
    assert!(
        text.contains("hit Hardware watchpoint 1: *(unsigned int *)0x20000000"),
        "{text}"
    );
    assert!(text.contains("Old value"), "{text}");
}

/// A packet with its checksum.
fn packet(data: &str) -> Vec<u8> {
    let sum = data.bytes().fold(0u8, |sum, b| sum.wrapping_add(b));
    format!("${data}#{sum:02x}").into_bytes()
}

#[test]
fn an_interrupt_stops_a_running_device_and_a_fault_is_told() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    let client = std::thread::spawn(move || {
        let mut stream = TcpStream::connect(address).expect("it listens");
        let mut said = String::new();
        let mut wait_for = |stream: &mut TcpStream, what: &str| {
            let mut bytes = [0; 1024];
            while !said.contains(what) {
                let got = stream.read(&mut bytes).expect("it answers");
                assert!(got > 0, "the port closed; it said {said}");
                said += &String::from_utf8_lossy(&bytes[..got]);
            }
            said.clear();
        };
        stream.write_all(&packet("c")).expect("sent");
        stream.write_all(b"\x03").expect("sent");
        wait_for(&mut stream, "T02thread:1;");
        // A jump to where nothing is.
        stream.write_all(&packet("Pf=00000030")).expect("sent");
        wait_for(&mut stream, "OK");
        stream.write_all(&packet("c")).expect("sent");
        wait_for(&mut stream, "T0bthread:1;");
        stream.write_all(&packet("k")).expect("sent");
    });
    let mut board = Board::power_on(&tests::image()).expect("the image");
    let (stream, _) = listener.accept().expect("the client connects");
    let end = serve(&mut board, stream, not_for_ever).expect("the session ends as it should");
    client.join().expect("the client was content");
    assert_eq!(end, End::Killed);
    let fault = board.chip.bus.fault.as_ref().map(ToString::to_string);
    assert!(
        fault.is_some_and(|f| f.contains("nothing can be executed at 0x30000000")),
        "the fault names its cause"
    );
}
