//! The ports of the shipped image: at their highest rate, both ways, with nothing lost; replies between whole lines and in time.

use twin::board::Board;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Format, Recording, RecordingOptions};

fn booted() -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board
}

fn modes1() -> Box<Player<Recording>> {
    let options = RecordingOptions::new(Format::Cu8, 2_000_000);
    let recording =
        Recording::open(&tests::recording("modes1.bin"), &options).expect("the recording opens");
    Box::new(Player::new(recording, &FrontEnd::ADSBEE_1090))
}

/// Sends a line and returns what the console says within 50 ms.
fn ask(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(50).expect("the chip runs");
    String::from_utf8_lossy(&board.console_read()).into_owned()
}

fn counter(stats: &str, stage: &str, name: &str) -> u64 {
    tests::reception::device::counter(stats, stage, name)
        .unwrap_or_else(|| panic!("no {stage} {name} in {stats}"))
}

#[test]
fn three_megabaud_lose_nothing_in_either_direction() {
    let mut board = booted();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    ask(&mut board, "AT+PROTOCOL=COMMS_UART,BEAST");
    assert_eq!(ask(&mut board, "AT+BAUDRATE=COMMS_UART,3000000"), "OK\r\n");
    let before = ask(&mut board, "AT+STATS?");
    board.comms_read();
    board.play(modes1()).expect("playback starts");
    // The line is full towards the device all the time: 300 bytes a millisecond.
    let (mut sent, mut said) = (0, Vec::new());
    while !board.playback_finished() {
        let bytes: Vec<u8> = (0..300u32).map(|n| (n % 251) as u8 + 1).collect();
        board.comms_write(&bytes);
        sent += bytes.len() as u64;
        board.run_ms(1).expect("the chip runs");
        said.extend(board.comms_read());
    }
    board.run_ms(20).expect("the chip runs");
    said.extend(board.comms_read());
    let after = ask(&mut board, "AT+STATS?");
    let grown =
        |stage: &str, name: &str| counter(&after, stage, name) - counter(&before, stage, name);
    assert_eq!(grown("COMMS_UART", "received_lost"), 0, "{after}");
    assert_eq!(grown("COMMS_UART", "received"), sent, "{after}");
    assert_eq!(grown("COMMS_UART", "dropped"), 0, "{after}");
    let mut reader = twin::beast_stream::Reader::default();
    let frames = reader.read(&said);
    assert_eq!(reader.skipped, 0);
    assert_eq!(frames.len() as u64, grown("QUEUE", "offered"), "{after}");
    assert!(frames.len() > 280, "{}", frames.len());
}

/// Four hundred aircraft on the air, heard by the image.
fn crowded() -> Board {
    let mut board = booted();
    let (wave, _) = tests::reception::limit::back_to_back(200);
    board
        .play(Box::new(Player::new(wave, &FrontEnd::ADSBEE_1090)))
        .expect("playback starts");
    while !board.playback_finished() {
        board.run_ms(1).expect("the chip runs");
    }
    board
}

#[test]
fn a_reply_starts_within_10_ms_of_its_command_and_between_whole_lines_of_a_burst() {
    let mut board = crowded();
    ask(&mut board, "AT+PROTOCOL=COMMS_UART,NONE");
    ask(&mut board, "AT+PROTOCOL=CONSOLE,CSBEE");
    let mut said = Vec::new();
    // Into the burst of a second.
    for _ in 0..1_500 {
        board.run_ms(1).expect("the chip runs");
        said.extend(board.console_read());
        if said.windows(3).filter(|bytes| bytes == b"#A:").count() > 20 {
            break;
        }
    }
    let burst_so_far = said.len();
    board.console_write(b"AT+PROTOCOL?\r\n");
    let mut waited_ms = 0;
    while !String::from_utf8_lossy(&said[burst_so_far..]).contains("+PROTOCOL=") {
        board.run_ms(1).expect("the chip runs");
        said.extend(board.console_read());
        waited_ms += 1;
        assert!(
            waited_ms <= 10,
            "no reply: {}",
            String::from_utf8_lossy(&said)
        );
    }
    board.run_ms(900).expect("the chip runs");
    said.extend(board.console_read());
    let text = String::from_utf8(said).expect("text");
    let lines: Vec<&str> = text.split_inclusive("\r\n").collect();
    let after = lines
        .iter()
        .skip_while(|line| !line.starts_with("+PROTOCOL="));
    assert!(
        after.filter(|line| line.starts_with("#A:")).count() > 100,
        "the burst was over: {text}"
    );
    for line in lines {
        let whole = line.starts_with('#') && line.matches(',').count() >= 5
            || line.starts_with("+PROTOCOL=");
        assert!(whole && line.ends_with("\r\n"), "{line:?}");
    }
}

#[test]
fn a_slow_port_tells_four_hundred_aircraft_in_turn_and_counts_those_it_missed() {
    let mut board = crowded();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    ask(&mut board, "AT+PROTOCOL=COMMS_UART,CSBEE");
    ask(&mut board, "AT+LOG_LEVEL=INFO");
    board.comms_read();
    let before = ask(&mut board, "AT+STATS?");
    let (mut said, mut logged) = (Vec::new(), String::new());
    for ms in 0..6_000 {
        if ms == 3_000 {
            // Beside a binary protocol there is no log.
            assert!(
                logged.contains("[INFO] COMMS_UART had no room for "),
                "{logged:?}"
            );
            ask(&mut board, "AT+PROTOCOL=CONSOLE,GDL90");
        }
        board.run_ms(1).expect("the chip runs");
        said.extend(board.comms_read());
        let console = board.console_read();
        if ms < 3_000 {
            logged.push_str(&String::from_utf8_lossy(&console));
        } else {
            assert!(!console.windows(6).any(|bytes| bytes == b"[INFO]"));
        }
    }
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    let after = ask(&mut board, "AT+STATS?");
    let text = String::from_utf8_lossy(&said).into_owned();
    let mut told = std::collections::BTreeMap::<&str, u32>::new();
    for line in text
        .split_inclusive("\r\n")
        .filter(|line| line.ends_with("\r\n"))
    {
        if let Some(rest) = line.strip_prefix("#A:") {
            *told.entry(&rest[..6]).or_default() += 1;
        }
    }
    let tracked = counter(&after, "TRACKER", "tracked");
    let (least, most) = (told.values().min(), told.values().max());
    assert_eq!(told.len() as u64, tracked, "{after}");
    assert!(
        most.zip(least)
            .is_some_and(|(most, least)| most - least <= 1),
        "{told:?}"
    );
    let grown =
        |name: &str| counter(&after, "COMMS_UART", name) - counter(&before, "COMMS_UART", name);
    assert!(grown("aircraft_dropped") > tracked, "{after}");
    assert_eq!(grown("offered"), grown("sent") + grown("dropped"));
}
