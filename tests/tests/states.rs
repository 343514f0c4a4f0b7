//! RUN and CONFIGURATION as they show outside, beside the dialogues of `tests/transcripts`: rates that a real far end keeps, reception that stands still, the LED.

use twin::beast_stream::{Reader, Received};
use twin::board::Board;
use twin::chip::uart::FarFormat;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Format, Recording, RecordingOptions};

const RUN_BAUD: u32 = 921_600;
const FIXED_BAUD: u32 = 115_200;

/// A far end that keeps its own rate, as a real one does.
fn far_end(board: &mut Board, baud: u32) {
    let uart = board.kind.comms_uart;
    board.chip.bus.uart[uart].far.format = Some(FarFormat::eight_n_one(baud));
}

fn comms(board: &mut Board, line: &str) -> Vec<u8> {
    board.comms_read();
    board.comms_write(format!("{line}\r\n").as_bytes());
    board.run_ms(60).expect("the chip runs");
    board.comms_read()
}

fn console(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(60).expect("the chip runs");
    String::from_utf8_lossy(&board.console_read()).into_owned()
}

/// Traffic on the air; when it began, seconds.
fn air(board: &mut Board) -> f64 {
    let options = RecordingOptions::new(Format::Cu8, 2_000_000);
    let recording =
        Recording::open(&tests::recording("modes1.bin"), &options).expect("the recording opens");
    let player = Player::new(recording, &FrontEnd::ADSBEE_1090);
    board.play(Box::new(player)).expect("playback starts");
    board.seconds()
}

/// The Beast frames that COMMS_UART sent.
fn frames(board: &mut Board) -> Vec<Received> {
    let mut reader = Reader::default();
    let frames = reader.read(&board.comms_read());
    assert_eq!(reader.skipped, 0);
    frames
}

/// Words of samples so far: taken, looked at, passed over.
struct Words {
    sampled: u64,
    demodulated: u64,
    unheard: u64,
}

fn words(board: &mut Board) -> Words {
    Words {
        sampled: counter(board, "CAPTURE", "words"),
        demodulated: counter(board, "DEMOD", "words"),
        unheard: counter(board, "CAPTURE", "unheard_words"),
    }
}

fn counter(board: &mut Board, stage: &str, name: &str) -> u64 {
    let stats = console(board, "AT+STATS?");
    // In CONFIGURATION the same lines stand behind "AT+".
    let stats = stats.replace("AT+STATS", "+STATS");
    tests::reception::device::counter(&stats, stage, name)
        .unwrap_or_else(|| panic!("no {stage} {name} in {stats}"))
}

#[test]
fn configuration_speaks_at_its_rate_receives_nothing_and_blinks_slowly() {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    let set = console(&mut board, &format!("AT+BAUDRATE=COMMS_UART,{RUN_BAUD}"));
    assert!(set.ends_with("OK\r\n"), "{set:?}");
    let set = console(&mut board, "AT+PROTOCOL=COMMS_UART,BEAST");
    assert_eq!(set, "OK\r\n");

    // The last words of RUN leave at its rate, the first of CONFIGURATION at 115200.
    far_end(&mut board, RUN_BAUD);
    let said = comms(&mut board, "AT+CONFIG=1");
    let said = String::from_utf8_lossy(&said).into_owned();
    assert!(said.starts_with("AT+OK\r\nAT+RUN_END\r\n"), "{said:?}");
    assert!(!said.contains("AT+CONFIG_START"), "{said:?}");
    far_end(&mut board, FIXED_BAUD);
    assert_eq!(comms(&mut board, "AT+CONFIG?"), b"AT+CONFIG=1\r\n");

    // Traffic is on the air, and nothing is said of it: core 1 looks at none of its samples, and the sampler runs on.
    board.console_read();
    let (before, from_s) = (words(&mut board), board.seconds());
    air(&mut board);
    board.comms_read();
    let (mut blinks, mut lit) = (0, board.led());
    for _ in 0..200 {
        board.run_ms(10).expect("the chip runs");
        blinks += u32::from(board.led() != lit);
        lit = board.led();
    }
    // Half a second on, half a second off.
    assert!((3..=5).contains(&blinks), "{blinks} changes in 2 s");
    assert!(board.comms_read().is_empty());
    assert!(board.console_read().is_empty());
    let (after, to_s) = (words(&mut board), board.seconds());
    let sampled = after.sampled - before.sampled;
    let expected = (to_s - from_s) * 250_000.0;
    assert!(
        (sampled as f64 / expected - 1.0).abs() < 0.001,
        "{sampled} of {expected}"
    );
    assert_eq!(after.demodulated, before.demodulated);
    // The three are not read at one moment.
    let unheard = after.unheard - before.unheard;
    assert!(unheard.abs_diff(sampled) < 200, "{unheard} of {sampled}");
    assert_eq!(counter(&mut board, "QUEUE", "offered"), 0);
    assert_eq!(counter(&mut board, "TRACKER", "tracked"), 0);

    // And back: the last words at 115200, the reports at RUN's rate.
    let said = comms(&mut board, "AT+CONFIG=0");
    let said = String::from_utf8_lossy(&said).into_owned();
    assert!(said.starts_with("AT+OK\r\nAT+CONFIG_END\r\n"), "{said:?}");
    assert!(!said.contains("AT+RUN_START"), "{said:?}");
    far_end(&mut board, RUN_BAUD);
    board.comms_read();
    let first_at_s = air(&mut board);
    board.run_ms(300).expect("the chip runs");
    let first = frames(&mut board);
    assert!(first.len() > 100, "{}", first.len());

    // Reception off is the same silence in RUN.
    assert!(console(&mut board, "AT+RX_ENABLE=0").ends_with("OK\r\n"));
    board.run_ms(500).expect("the chip runs");
    board.comms_read();
    let before = words(&mut board);
    air(&mut board);
    board.run_ms(300).expect("the chip runs");
    assert!(board.comms_read().is_empty());
    let after = words(&mut board);
    assert_eq!(after.demodulated, before.demodulated);
    assert!(after.unheard > before.unheard + 75_000);

    // Back on: every word is looked at again, none counts as lost, and the stamps have gone on as if nothing had been.
    assert!(console(&mut board, "AT+RX_ENABLE=1").ends_with("OK\r\n"));
    board.comms_read();
    let (before, from_s) = (words(&mut board), board.seconds());
    let second_at_s = air(&mut board);
    board.run_ms(300).expect("the chip runs");
    let second = frames(&mut board);
    let (after, to_s) = (words(&mut board), board.seconds());
    assert!(second.len() > 100, "{}", second.len());
    assert_eq!(after.unheard, before.unheard);
    let looked = after.demodulated - before.demodulated;
    let expected = (to_s - from_s) * 250_000.0;
    assert!(
        (looked as f64 / expected - 1.0).abs() < 0.01,
        "{looked} of {expected}"
    );
    assert_eq!(counter(&mut board, "DEMOD", "overruns"), 0);
    // A frame that was received both times, at the same place of the recording.
    let age = |frame: &Received, board_s: f64| board_s - frame.stamp as f64 / 12e6;
    let is_once = |frames: &[Received], bytes: &[u8]| {
        frames.iter().filter(|frame| frame.bytes == bytes).count() == 1
    };
    let ages: Vec<(f64, f64)> = first
        .iter()
        .filter(|one| is_once(&first, &one.bytes) && is_once(&second, &one.bytes))
        .filter_map(|one| {
            let other = second.iter().find(|other| other.bytes == one.bytes)?;
            Some((age(one, first_at_s), age(other, second_at_s)))
        })
        .collect();
    assert!(ages.len() > 50, "{}", ages.len());
    let same = ages.iter().filter(|(a, b)| (a - b).abs() < 1e-4).count();
    assert!(
        same * 10 > ages.len() * 9,
        "{same} of {}: {ages:?}",
        ages.len()
    );
}
