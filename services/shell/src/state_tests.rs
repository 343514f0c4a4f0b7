//! The table of the module, row by row: all events in all states.

use super::*;

const FIXED: State = configuration(false, true);
const AS_SET: State = configuration(true, true);
const BY_PIN: State = configuration(false, false);
const AS_SET_UNLOCKED: State = configuration(true, false);

const EVENTS: [Event; 10] = [
    Event::ConfigFixed,
    Event::ConfigAsSet,
    Event::ConfigEnd,
    Event::Lock,
    Event::Unlock,
    Event::PinLow,
    Event::PinReleased,
    Event::Reboot,
    Event::RebootBootloader,
    Event::BootUsb,
];

/// State, pin held, then what each of `EVENTS` leads to.
type Row = (State, bool, [(State, &'static [Step]); 10]);

#[rustfmt::skip]
const TABLE: [Row; 9] = [
    (State::Run, false, [
        (FIXED, ENTER_FIXED), (AS_SET, ENTER_AS_SET), (State::Run, ANSWER), (State::Run, REFUSE), (State::Run, REFUSE),
        (BY_PIN, ENTER_FIXED), (State::Run, &[]), (State::Run, RESTART), (State::Run, RESTART_LOCKED),
        (State::Run, RESTART_USB),
    ]),
    // Left by AT+CONFIG=0 while the pin is still held.
    (State::Run, true, [
        (FIXED, ENTER_FIXED), (AS_SET, ENTER_AS_SET), (State::Run, ANSWER), (State::Run, REFUSE), (State::Run, REFUSE),
        (BY_PIN, ENTER_FIXED), (State::Run, &[]), (State::Run, RESTART), (State::Run, RESTART_LOCKED),
        (State::Run, RESTART_USB),
    ]),
    (FIXED, false, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (FIXED, ANSWER), (State::Run, LEAVE),
        (FIXED, &[]), (FIXED, &[]), (FIXED, SAVE_RESTART), (FIXED, SAVE_RESTART_LOCKED),
        (FIXED, SAVE_RESTART_USB),
    ]),
    (FIXED, true, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (FIXED, ANSWER), (BY_PIN, ANSWER),
        (FIXED, &[]), (FIXED, &[]), (FIXED, SAVE_RESTART), (FIXED, SAVE_RESTART_LOCKED),
        (FIXED, SAVE_RESTART_USB),
    ]),
    (AS_SET, false, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (AS_SET, ANSWER), (State::Run, LEAVE),
        (AS_SET, &[]), (AS_SET, &[]), (AS_SET, SAVE_RESTART), (AS_SET, SAVE_RESTART_LOCKED),
        (AS_SET, SAVE_RESTART_USB),
    ]),
    (AS_SET, true, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (AS_SET, ANSWER), (AS_SET_UNLOCKED, ANSWER),
        (AS_SET, &[]), (AS_SET, &[]), (AS_SET, SAVE_RESTART), (AS_SET, SAVE_RESTART_LOCKED),
        (AS_SET, SAVE_RESTART_USB),
    ]),
    (BY_PIN, true, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (FIXED, ANSWER), (BY_PIN, ANSWER),
        (BY_PIN, &[]), (State::Run, LEAVE), (BY_PIN, SAVE_RESTART), (BY_PIN, SAVE_RESTART_LOCKED),
        (BY_PIN, SAVE_RESTART_USB),
    ]),
    (AS_SET_UNLOCKED, true, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (AS_SET, ANSWER), (AS_SET_UNLOCKED, ANSWER),
        (AS_SET_UNLOCKED, &[]), (State::Run, LEAVE), (AS_SET_UNLOCKED, SAVE_RESTART), (AS_SET_UNLOCKED, SAVE_RESTART_LOCKED),
        (AS_SET_UNLOCKED, SAVE_RESTART_USB),
    ]),
    // Does not last: the pin's release ends it. Complete all the same.
    (BY_PIN, false, [
        (FIXED, TO_FIXED), (AS_SET, TO_SET), (State::Run, LEAVE), (FIXED, ANSWER), (State::Run, LEAVE),
        (BY_PIN, &[]), (State::Run, LEAVE), (BY_PIN, SAVE_RESTART), (BY_PIN, SAVE_RESTART_LOCKED),
        (BY_PIN, SAVE_RESTART_USB),
    ]),
];

#[test]
fn every_event_in_every_state() {
    for (state, pin_held, row) in TABLE {
        for (event, (next, steps)) in EVENTS.into_iter().zip(row) {
            let mut machine = Machine { state, pin_held };
            let case = std::format!("{state:?} {event:?} pin {pin_held}");
            assert_eq!(machine.take(event), steps, "{case}");
            assert_eq!(machine.state(), next, "{case}");
            let held = match event {
                Event::PinLow => true,
                Event::PinReleased => false,
                _ => pin_held,
            };
            assert_eq!(machine.is_pin_held(), held, "{case}");
        }
    }
}

#[test]
fn every_walk_of_two_events_says_each_end_after_its_start() {
    for first in EVENTS {
        for second in EVENTS {
            let mut machine = Machine::new(false);
            let mut said = std::vec![RUN_START];
            for event in [first, second] {
                for step in machine.take(event) {
                    if let Step::Say(text) = step {
                        said.push(text);
                    }
                }
            }
            let order = [RUN_START, RUN_END, CONFIG_START, CONFIG_END];
            for pair in said.windows(2) {
                let index = |text| order.iter().position(|o| *o == text).unwrap();
                assert_eq!(
                    index(pair[1]),
                    (index(pair[0]) + 1) % 4,
                    "{first:?} {second:?}"
                );
            }
            let is_run = machine.state() == State::Run;
            assert_eq!(
                said.last() == Some(&RUN_START),
                is_run,
                "{first:?} {second:?}"
            );
        }
    }
}

#[test]
fn what_is_left_of_configuration_is_saved_first() {
    for steps in [LEAVE, SAVE_RESTART, SAVE_RESTART_LOCKED, SAVE_RESTART_USB] {
        assert_eq!(steps[..2], [Step::Save, Step::Answer]);
    }
}
