//! A fork of a running board, with the shipped image on the air, and one that went through a file: each goes on as the first one, bit for bit and
//! cycle for cycle, and what happens to one does not concern the other.

use std::sync::Arc;

use twin::board::{Board, Error};
use twin::chip::pins::Again;
use twin::front_end::{FrontEnd, Player, PulseSource};
use twin::snapshot;
use twin::source::{Air, AirOptions, OnAir};

/// A DF11 every millisecond, over noise.
fn air() -> Box<dyn PulseSource + Send> {
    let frame = mode_s::Frame::from_bytes(&[0x5d, 0x4b, 0x18, 0xff, 0xfc, 0x71, 0x0b]);
    let frame = frame.expect("a DF11");
    let messages = (1..1_000u64).map(move |ms| OnAir {
        at_ps: ms * 1_000_000_000,
        frame,
    });
    Box::new(Player::new(
        Air::new(messages, AirOptions::default()),
        &FrontEnd::ADSBEE_1090,
    ))
}

/// All that a program could notice of a board.
fn state(board: &mut Board) -> (u64, [u64; 2], [u64; 2], [u32; 2], u64, Vec<u8>) {
    let chip = &board.chip;
    let sram = chip
        .bus
        .sram
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
        });
    (
        chip.now(),
        chip.busy_cycles(),
        chip.wait_cycles(),
        [0, 1].map(|core| chip.program_counter(core)),
        sram,
        board.console_read(),
    )
}

#[test]
fn a_fork_goes_on_as_the_board_does() {
    let mut board = Board::power_on(&tests::image()).expect("the image boots");
    board.wait_for_console().expect("the console opens");
    board
        .play_repeatable(Arc::new(air))
        .expect("capture starts");
    board.run_ms(30).expect("it runs");
    let mut fork = board.fork().expect("the source can be repeated");
    let mut file = Vec::new();
    board.save(&mut file).expect("all its parts can be kept");
    let again: Again = Arc::new(air);
    let mut resumed = Board::resume(&mut file.as_slice(), Some(&again)).expect("it is whole");
    for board in [&mut board, &mut fork, &mut resumed] {
        board.console_write(b"AT+STATS?\r\n");
    }
    for step in 0..3 {
        for board in [&mut board, &mut fork, &mut resumed] {
            board.run_ms(20).expect("it runs");
        }
        let one = state(&mut board);
        assert_eq!(one, state(&mut fork), "step {step}");
        assert_eq!(one, state(&mut resumed), "step {step}, from the file");
        assert!(step > 0 || !one.5.is_empty(), "the console answered");
    }
    let source_missing = Board::resume(&mut file.as_slice(), None);
    assert!(matches!(
        source_missing,
        Err(snapshot::Error::WithoutSource)
    ));
    let other: Again = Arc::new(|| {
        let frame = mode_s::Frame::from_bytes(&[0x5d, 0x4b, 0x18, 0xff, 0xfc, 0x71, 0x0b]);
        let once = frame.map(|frame| OnAir {
            at_ps: 5_000_000_000,
            frame,
        });
        let air = Air::new(once.into_iter(), AirOptions::default());
        Box::new(Player::new(air, &FrontEnd::ADSBEE_1090))
    });
    let other = Board::resume(&mut file.as_slice(), Some(&other));
    assert!(matches!(other, Err(snapshot::Error::OtherSource)));
    refuses_what_is_no_snapshot_of_this_build(file);
    // A word of the ring changed in one is not changed in the other.
    let before = fork.chip.bus.sram[0];
    board.chip.bus.sram[0] ^= 0xff;
    assert_eq!(fork.chip.bus.sram[0], before);
}

fn refuses_what_is_no_snapshot_of_this_build(file: Vec<u8>) {
    let resume = |bytes: &[u8]| Board::resume(&mut &bytes[..], None).err();
    let (head, middle) = (b"squitter twin\n".len(), file.len() / 2);
    for cut in [
        0,
        head,
        head + 16,
        head + 17,
        head + 24,
        middle,
        file.len() - 1,
    ] {
        assert!(resume(&file[..cut]).is_some(), "cut at {cut}");
    }
    let turned = |at: usize| {
        let mut bytes = file.clone();
        bytes[at] ^= 1;
        resume(&bytes)
    };
    assert!(matches!(turned(0), Some(snapshot::Error::NotASnapshot)));
    assert!(matches!(turned(head), Some(snapshot::Error::OtherBuild(_))));
    assert!(matches!(turned(middle), Some(snapshot::Error::Damaged(_))));
}

#[test]
fn a_board_whose_radio_cannot_be_repeated_refuses_to_fork() {
    let mut board = Board::power_on(&tests::image()).expect("the image boots");
    assert!(board.fork().is_ok(), "nothing plays");
    board.play(air()).expect("capture starts");
    assert!(matches!(board.fork(), Err(Error::Unrepeatable)));
    let kept = board.save(&mut Vec::new());
    assert!(matches!(kept, Err(snapshot::Error::Unkeepable(_))));
}
