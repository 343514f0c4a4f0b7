use super::*;
use std::vec::Vec;

const LENGTH: usize = 5000;

fn file() -> Vec<u8> {
    (0..LENGTH).map(|n| (n * 7 + n / 256) as u8).collect()
}

/// A block of `data` filled up with `fill`.
fn block(number: u8, data: &[u8], fill: u8) -> Vec<u8> {
    let size = if data.len() > 128 { MOST_DATA } else { 128 };
    let mut padded = data.to_vec();
    padded.resize(size, fill);
    let crc = CRC.checksum(&padded).to_be_bytes();
    let start = if size == 128 { SOH } else { STX };
    [&[start, number, !number], &padded[..], &crc].concat()
}

fn first_block(text: &[u8]) -> Vec<u8> {
    block(0, text, 0)
}

/// The blocks of a transfer, each as it is sent, without the closing ones.
fn blocks() -> Vec<Vec<u8>> {
    let mut blocks = std::vec![first_block(b"update.sqt\x005000 0 0")];
    for (n, data) in file().chunks(MOST_DATA).enumerate() {
        blocks.push(block(n as u8 + 1, data, 0x1A));
    }
    blocks
}

/// A receiver with its clock, what it took, and what it said.
struct Line {
    receiver: Receiver,
    now_ms: u64,
    taken: Vec<u8>,
    said: Vec<u8>,
    begun: Option<u32>,
    ended: bool,
    done: bool,
    aborted: Option<Abort>,
}

impl Line {
    fn new() -> Self {
        Self {
            receiver: Receiver::new(0),
            now_ms: 0,
            taken: Vec::new(),
            said: Vec::new(),
            begun: None,
            ended: false,
            done: false,
            aborted: None,
        }
    }

    fn deal(&mut self, byte: Option<u8>) {
        let now_ms = self.now_ms;
        let event = match byte {
            Some(byte) => self.receiver.byte(byte, now_ms),
            None => self.receiver.tick(now_ms),
        };
        let answer = match event {
            Event::Nothing => false,
            Event::Begin(length) => {
                self.begun = Some(length);
                true
            }
            Event::Data(bytes) => {
                self.taken.extend(bytes);
                true
            }
            Event::End => {
                self.ended = true;
                true
            }
            Event::Done => {
                self.done = true;
                false
            }
            Event::Aborted(why) => {
                self.aborted = Some(why);
                false
            }
        };
        if answer {
            self.receiver.accept(now_ms);
        }
        while let Some(byte) = self.receiver.reply() {
            self.said.push(byte);
        }
    }

    /// Sends bytes; gives what was answered.
    fn send(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.said.clear();
        for &byte in bytes {
            self.deal(Some(byte));
        }
        self.said.clone()
    }

    /// Lets time pass; gives what was said.
    fn wait(&mut self, ms: u64) -> Vec<u8> {
        self.said.clear();
        let end = self.now_ms + ms;
        while self.now_ms < end {
            self.now_ms += 50;
            self.deal(None);
        }
        self.said.clone()
    }

    /// Up to and with block `last` of the file.
    fn blocks_to(&mut self, last: usize) {
        assert_eq!(self.wait(50), b"C");
        for (n, block) in blocks().iter().enumerate().take(last + 1) {
            let expected: &[u8] = if n == 0 { &[ACK, b'C'] } else { &[ACK] };
            assert_eq!(self.send(block), expected, "block {n}");
        }
    }

    fn close(&mut self) {
        assert_eq!(self.send(&[EOT]), [NAK]);
        assert_eq!(self.send(&[EOT]), [ACK, b'C']);
        assert_eq!(self.send(&first_block(&[])), [ACK]);
        assert!(self.ended && self.done);
        assert_eq!(self.taken, file());
    }
}

#[test]
fn a_file_arrives_whole_with_its_length() {
    let mut line = Line::new();
    line.blocks_to(5);
    assert_eq!(line.begun, Some(LENGTH as u32));
    line.close();
}

#[test]
fn the_sender_is_invited_every_second_for_a_minute() {
    let mut line = Line::new();
    let said = line.wait(59_000);
    assert!((59..=60).contains(&said.len()) && said.iter().all(|&byte| byte == b'C'));
    line.wait(2000);
    assert_eq!(line.aborted, Some(Abort::NotStarted));
}

#[test]
fn a_damaged_block_is_asked_for_again_once_the_line_is_quiet() {
    for at in [1, 2, 3, 500, 1027, 1028] {
        let mut line = Line::new();
        line.blocks_to(1);
        let mut bad = blocks()[2].clone();
        bad[at] ^= 0x10;
        assert_eq!(line.send(&bad), []);
        assert_eq!(line.wait(600), [NAK]);
        assert_eq!(line.send(&blocks()[2]), [ACK]);
        for block in &blocks()[3..] {
            assert_eq!(line.send(block), [ACK]);
        }
        line.close();
    }
}

/// The errors in a row are counted, not those of a transfer: a long file over a bad line still arrives.
#[test]
fn a_bit_error_in_every_block_does_not_end_a_transfer() {
    let mut line = Line::new();
    line.blocks_to(0);
    for block in &blocks()[1..] {
        for round in 0..MOST_ERRORS - 1 {
            let mut bad = block.clone();
            bad[100 + usize::from(round)] ^= 1;
            line.send(&bad);
            assert_eq!(line.wait(600), [NAK]);
        }
        assert_eq!(line.send(block), [ACK]);
    }
    line.close();
}

#[test]
fn too_many_errors_in_a_row_end_it() {
    let mut line = Line::new();
    line.blocks_to(1);
    let mut bad = blocks()[2].clone();
    bad[10] ^= 1;
    for _ in 1..MOST_ERRORS {
        line.send(&bad);
        assert_eq!(line.wait(600), [NAK]);
    }
    line.send(&bad);
    assert_eq!(line.wait(600), [CAN, CAN, CAN]);
    assert_eq!(line.aborted, Some(Abort::Errors));
}

#[test]
fn bytes_that_are_missing_inside_a_block_make_it_bad() {
    let mut line = Line::new();
    line.blocks_to(1);
    line.send(&blocks()[2][..700]);
    assert_eq!(line.wait(600), [NAK]);
    assert_eq!(line.send(&blocks()[2]), [ACK]);
}

#[test]
fn a_repeated_block_is_acknowledged_and_dropped() {
    let mut line = Line::new();
    line.blocks_to(0);
    assert_eq!(line.send(&blocks()[0]), [ACK, b'C']);
    for block in &blocks()[1..] {
        assert_eq!(line.send(block), [ACK]);
        assert_eq!(line.send(block), [ACK]);
    }
    line.close();
}

#[test]
fn a_block_out_of_order_ends_it() {
    for (after, sent) in [(0, 2), (2, 4), (3, 1)] {
        let mut line = Line::new();
        line.blocks_to(after);
        assert_eq!(line.send(&blocks()[sent]), [CAN, CAN, CAN]);
        assert_eq!(line.aborted, Some(Abort::OutOfOrder));
    }
}

#[test]
fn two_can_in_a_row_end_it_and_one_does_not() {
    let mut line = Line::new();
    line.blocks_to(1);
    line.send(&[CAN]);
    assert_eq!(line.aborted, None);
    assert_eq!(line.send(&blocks()[2]), [ACK]);
    line.send(&[CAN, CAN]);
    assert_eq!(line.aborted, Some(Abort::Cancelled));
}

/// Wherever the sender stops, the prompt is back within ten seconds.
#[test]
fn a_silence_at_any_block_ends_it_within_ten_seconds() {
    for last in 0..=5 {
        for part in [0, 1, 500] {
            let mut line = Line::new();
            line.blocks_to(last);
            let next = blocks().get(last + 1).cloned().unwrap_or_default();
            line.send(&next[..part.min(next.len())]);
            line.wait(10_000);
            assert_eq!(line.aborted, Some(Abort::Stalled), "{last} {part}");
        }
    }
}

#[test]
fn a_file_shorter_than_announced_is_told() {
    let mut line = Line::new();
    line.blocks_to(3);
    line.send(&[EOT]);
    assert_eq!(line.send(&[EOT]), [CAN, CAN, CAN]);
    assert_eq!(line.aborted, Some(Abort::Short));
}

#[test]
fn a_name_without_a_length_and_an_empty_name_are_refused() {
    for (text, why) in [
        (&b"update.sqt\0"[..], Abort::NoLength),
        (b"update.sqt", Abort::NoLength),
        (b"update.sqt\x0099999999999", Abort::NoLength),
        (b"", Abort::NotStarted),
    ] {
        let mut line = Line::new();
        line.wait(50);
        line.send(&first_block(text));
        assert_eq!(line.aborted, Some(why), "{text:?}");
        assert_eq!(line.begun, None);
    }
}

#[test]
fn a_sender_that_does_not_close_the_session_has_still_sent_its_file() {
    let mut line = Line::new();
    line.blocks_to(5);
    line.send(&[EOT]);
    line.send(&[EOT]);
    assert!(line.ended && !line.done);
    line.wait(9000);
    assert!(line.done && line.aborted.is_none());
}

#[test]
fn any_bytes_at_any_time_neither_panic_nor_pile_up() {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 16
    };
    for _ in 0..200 {
        let mut line = Line::new();
        if next() % 2 == 0 {
            line.blocks_to(next() as usize % 5);
        }
        for _ in 0..3000 {
            let byte = match next() % 8 {
                0 => SOH,
                1 => STX,
                2 => EOT,
                3 => 0,
                4 => 0xFF,
                _ => next() as u8,
            };
            line.deal(Some(byte));
            if next() % 500 == 0 {
                line.wait(u64::from(next() % 2000));
            }
        }
        assert!(line.taken.len() <= LENGTH);
    }
}
