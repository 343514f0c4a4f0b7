//! The dialogue's table, row by row, against receivers that answer, refuse, and say nothing.

use super::*;
use crate::frame::checksum;
use proptest::prelude::*;
use std::vec::Vec;

/// What a receiver makes of a message: accepted, refused, no answer.
type Manner = fn(&[u8]) -> Option<bool>;

fn answer(kind: [u8; 2], accepted: bool) -> [u8; 10] {
    let mut frame = [
        0xB5,
        0x62,
        5,
        u8::from(accepted),
        2,
        0,
        kind[0],
        kind[1],
        0,
        0,
    ];
    [frame[8], frame[9]] = checksum(&frame, 2, 8);
    frame
}

/// Runs to `until_ms` with such a receiver; gives the messages' names with their times.
fn talk(
    asker: &mut Configurator,
    manner: Manner,
    from_ms: u64,
    until_ms: u64,
) -> Vec<(u64, &'static str)> {
    let mut sent = Vec::new();
    for now_ms in (from_ms..until_ms).step_by(50) {
        let Some(bytes) = asker.due(now_ms) else {
            continue;
        };
        asker.sent(now_ms);
        let found = MESSAGES.iter().find(|message| message.bytes == bytes);
        sent.push((now_ms, found.expect("one of the messages").name));
        if let Some(accepted) = manner(bytes) {
            for byte in answer([bytes[2], bytes[3]], accepted) {
                assert!(asker.feed(byte, now_ms));
            }
        }
    }
    sent
}

fn wanted() -> Configurator {
    let mut asker = Configurator::new();
    asker.want(true);
    asker
}

fn names(sent: &[(u64, &'static str)]) -> Vec<&'static str> {
    sent.iter().map(|(_, name)| *name).collect()
}

const BY_KEYS: [&str; 3] = ["CFG-VALSET-TP", "CFG-VALSET-MSGOUT", "CFG-VALSET-RATE"];

/// Up to M8: no keys.
fn without_keys(bytes: &[u8]) -> Option<bool> {
    Some(bytes[3] != 0x8A)
}

#[test]
fn nothing_is_sent_unless_it_is_wanted_and_nothing_is_taken() {
    let mut asker = Configurator::new();
    assert!(talk(&mut asker, |_| Some(true), 0, 20_000).is_empty());
    assert!(
        !answer([6, 1], true)
            .into_iter()
            .any(|byte| asker.feed(byte, 0))
    );
    assert_eq!(asker.state(), State::Off);
    asker.want(true);
    assert_eq!(asker.state(), State::Asking);
    asker.want(false);
    assert_eq!((asker.state(), asker.due(0)), (State::Off, None));
}

#[test]
fn a_receiver_with_keys_gets_three_messages() {
    let mut asker = wanted();
    let sent = talk(&mut asker, |_| Some(true), 0, 10_000);
    assert_eq!(names(&sent), BY_KEYS);
    assert_eq!((asker.state(), asker.ended()), (State::Configured, 1));
    // Wanted still is not wanted anew.
    asker.want(true);
    assert_eq!(asker.due(10_000), None);
}

#[test]
fn an_older_one_gets_messages_whether_it_refuses_keys_or_ignores_them() {
    let all: Vec<_> = MESSAGES.iter().map(|message| message.name).collect();
    let mut asker = wanted();
    let sent = talk(&mut asker, without_keys, 0, 10_000);
    assert_eq!(names(&sent), [&all[..1], &all[3..]].concat());
    assert_eq!(asker.state(), State::Configured);

    let mut asker = wanted();
    let ignores: Manner = |bytes| (bytes[3] != 0x8A).then_some(true);
    let sent = talk(&mut asker, ignores, 0, 10_000);
    assert_eq!(names(&sent), [&[all[0]; 3], &all[3..]].concat());
    assert_eq!(sent[3].0, u64::from(TRIES) * ANSWER_MS);
    assert_eq!(asker.state(), State::Configured);
}

#[test]
fn what_is_refused_is_named_and_the_others_are_told_all_the_same() {
    let refuses_rate: Manner = |bytes| Some(bytes != MESSAGES[2].bytes);
    let mut asker = wanted();
    assert_eq!(names(&talk(&mut asker, refuses_rate, 0, 10_000)), BY_KEYS);
    assert_eq!(asker.state(), State::Refused("CFG-VALSET-RATE"));

    let refuses_two: Manner = |bytes| {
        let refused = [0, 4, 11].map(|place: usize| MESSAGES[place].bytes);
        Some(!refused.contains(&bytes))
    };
    let mut asker = wanted();
    assert_eq!(talk(&mut asker, refuses_two, 0, 10_000).len(), 11);
    assert_eq!(asker.state(), State::Refused("CFG-RATE"));
    assert_eq!(asker.ended(), 1);
}

#[test]
fn silence_ends_the_dialogue_and_a_sentence_begins_it_anew() {
    let mut asker = wanted();
    let sent = talk(&mut asker, |_| None, 0, 60_000);
    assert_eq!(
        names(&sent),
        [["CFG-VALSET-TP"; 3], ["CFG-TP5"; 3]].concat()
    );
    assert_eq!((asker.state(), asker.ended()), (State::NoAnswer, 1));
    asker.sentence(b"$GNRMC", 60_000);
    assert_eq!(asker.state(), State::Asking);
    // One that falls silent on the way.
    let sent = talk(
        &mut asker,
        |bytes| (bytes[3] == 0x8A).then_some(bytes.len() > 100),
        60_000,
        90_000,
    );
    assert_eq!(asker.state(), State::NoAnswer, "{sent:?}");
    // Sentences that go on are no return.
    asker.sentence(b"$GNRMC", 64_999);
    assert_eq!(asker.state(), State::NoAnswer);
    asker.sentence(b"$GNRMC", 69_999);
    assert_eq!(asker.state(), State::Asking);
}

#[test]
fn a_receiver_that_was_away_or_has_forgotten_is_told_again() {
    let mut asker = wanted();
    talk(&mut asker, |_| Some(true), 0, 1_000);
    for second in 1..60 {
        asker.sentence(b"$GNRMC", second * 1_000);
        asker.sentence(b"$GNGSA", second * 1_000);
    }
    assert_eq!(asker.state(), State::Configured);
    asker.sentence(b"$GPGSV", 59_000);
    assert_eq!(asker.state(), State::Asking);
    talk(&mut asker, |_| Some(true), 59_000, 60_000);
    // It answers and forgets: not told at once again.
    asker.sentence(b"$GPGSV", 60_000);
    asker.sentence(b"$GNVTG", 64_900);
    asker.sentence(b"$GNGLL", 68_999);
    assert_eq!(asker.state(), State::Configured);
    asker.sentence(b"$GNGLL", 69_000);
    assert_eq!(asker.state(), State::Asking);
    talk(&mut asker, |_| Some(true), 69_000, 70_000);
    asker.sentence(b"$GNRMC", 75_000);
    assert_eq!((asker.state(), asker.ended()), (State::Asking, 3));
}

#[test]
fn answers_to_others_and_before_anything_was_sent_are_none() {
    let mut asker = wanted();
    for byte in answer([6, 0x8A], true) {
        asker.feed(byte, 0);
    }
    assert_eq!(names(&talk(&mut asker, |_| None, 0, 100)), BY_KEYS[..1]);
    for byte in answer([6, 0x31], true) {
        asker.feed(byte, 0);
    }
    assert_eq!(
        names(&talk(&mut asker, |_| None, 2_000, 2_100)),
        BY_KEYS[..1]
    );
}

proptest! {
    #[test]
    fn any_bytes_at_any_times_end_in_a_state_and_nothing_is_sent_too_often(
        bytes in proptest::collection::vec(prop_oneof![any::<u8>(), Just(0xB5), Just(0x62), Just(5), Just(6)], 0..400),
        step_ms in 0u64..200,
    ) {
        let mut asker = wanted();
        let mut sent = 0;
        let mut now_ms = 0;
        for byte in bytes {
            now_ms += step_ms;
            asker.feed(byte, now_ms);
            if asker.due(now_ms).is_some() {
                asker.sent(now_ms);
                sent += 1;
            }
        }
        prop_assert!(sent <= 3 * MESSAGES.len());
        for _ in 0..200 {
            now_ms += ANSWER_MS;
            if asker.due(now_ms).is_some() {
                asker.sent(now_ms);
            }
        }
        prop_assert_ne!(asker.state(), State::Asking);
    }
}
