//! The receiving end of YMODEM against the sender people have: `sb -k` of Debian's lrzsz, clean and over a line that flips bits.

use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use boot_core::ymodem::{Event, Receiver};
use tests::cpu_peer::dice::Dice;

/// Bytes of the file: a quarter of a mebibyte and some, so that its last block is not full.
const LENGTH: usize = 256 * 1024 + 77;
/// No transfer may take longer than this.
const PATIENCE: Duration = Duration::from_secs(60);

/// Receives what `sb` sends, each `flip_every`-th byte with a flipped bit. Gives the file and how many bytes came.
fn receive(name: &str, file: &[u8], flip_every: Option<usize>) -> (Vec<u8>, usize) {
    let path = std::env::temp_dir().join(format!("squitter-{}-{name}", std::process::id()));
    std::fs::write(&path, file).expect("the folder for temporary files is writable");
    let mut sender = Command::new("sb")
        .args(["-k", "-q"])
        .arg(&path)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("`sb` is missing; install lrzsz");
    let mut to_sender = sender.stdin.take().expect("piped");
    let mut from_sender = sender.stdout.take().expect("piped");
    let (bytes_in, bytes) = mpsc::channel();
    std::thread::spawn(move || {
        let mut piece = [0; 4096];
        while let Ok(count @ 1..) = from_sender.read(&mut piece) {
            if bytes_in.send(piece[..count].to_vec()).is_err() {
                return;
            }
        }
    });
    let start = Instant::now();
    let now_ms = || start.elapsed().as_millis() as u64;
    let mut receiver = Receiver::new(0);
    let (mut taken, mut seen, mut done) = (Vec::new(), 0, false);
    while !done {
        assert!(
            start.elapsed() < PATIENCE,
            "{name}: {} bytes taken",
            taken.len()
        );
        let piece = bytes
            .recv_timeout(Duration::from_millis(20))
            .unwrap_or_default();
        for byte in piece.iter().map(|&byte| Some(byte)).chain([None]) {
            let event = match byte {
                Some(mut byte) => {
                    seen += 1;
                    if flip_every.is_some_and(|every| seen % every == 0) {
                        byte ^= 1 << (seen / 7 % 8);
                    }
                    receiver.byte(byte, now_ms())
                }
                None => receiver.tick(now_ms()),
            };
            match event {
                Event::Nothing => {}
                Event::Begin(length) => {
                    assert_eq!(length as usize, file.len());
                    receiver.accept(now_ms());
                }
                Event::Data(data) => {
                    taken.extend_from_slice(data);
                    receiver.accept(now_ms());
                }
                Event::End => receiver.accept(now_ms()),
                Event::Done => done = true,
                Event::Aborted(why) => panic!("{name}: {}", why.reason()),
            }
            let replies: Vec<u8> = std::iter::from_fn(|| receiver.reply()).collect();
            // A sender that has closed the session no longer reads.
            let _ = to_sender
                .write_all(&replies)
                .and_then(|()| to_sender.flush());
        }
    }
    let status = sender.wait().expect("the sender can be waited for");
    let _ = std::fs::remove_file(&path);
    assert!(status.success(), "{name}: sb ended with {status}");
    (taken, seen)
}

fn file() -> Vec<u8> {
    let mut dice = Dice::new(1090);
    (0..LENGTH).map(|_| dice.bits() as u8).collect()
}

#[test]
fn a_clean_line() {
    let file = file();
    let (taken, _) = receive("clean", &file, None);
    assert!(taken == file);
}

#[test]
fn a_bit_error_every_5003_bytes() {
    let file = file();
    let (taken, seen) = receive("noisy", &file, Some(5003));
    assert!(taken == file);
    // Blocks were really sent again.
    assert!(seen > LENGTH + 20 * 1024, "{seen}");
}
