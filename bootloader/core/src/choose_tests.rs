use super::*;
use SlotName::{A, B};
use Standing::{Confirmed, Pending, Rejected, Trial};
use boot_contract::BOARD_ADSBEE_1090;
use boot_contract::header::{Date, HeaderError};

fn header(slot: SlotName) -> Header {
    Header {
        board: BOARD_ADSBEE_1090,
        link_address: slot.slot().link_address(),
        image_length: 1000,
        version: [1, 0, 0, 0],
        counter: 0,
        image_sha256: [slot.index() as u8 + 1; 32],
        image_crc: 0,
        key: [0; 8],
        date: Date {
            year: 2026,
            month: 1,
            day: 1,
        },
    }
}

fn log(a: Option<Standing>, b: Option<Standing>, last: Option<SlotName>) -> LogState {
    let of = |slot: SlotName, standing: Option<Standing>| {
        standing.map(|standing| (header(slot).image_id(), standing))
    };
    LogState {
        slots: [of(A, a), of(B, b)],
        confirmed_last: last,
        installed_last: None,
        floor: 0,
    }
}

const GOOD: [bool; 2] = [true, true];

fn verified(good: [bool; 2]) -> Verified {
    SlotName::ALL.map(|slot| {
        if good[slot.index()] {
            Ok(header(slot))
        } else {
            Err(Refusal::ImageHash)
        }
    })
}

/// The slot that runs, and the try that is logged.
fn runs(step: Step) -> Option<(SlotName, Option<u8>)> {
    match step {
        Step::Run { slot, first: None } => Some((slot, None)),
        Step::Run {
            slot,
            first: Some(Record::Trial { tries, .. }),
        } => Some((slot, Some(tries))),
        _ => None,
    }
}

#[test]
fn a_pending_image_is_tried_three_times_then_rejected() {
    for (standing, tries) in [(Pending, 1), (Trial(1), 2), (Trial(2), 3)] {
        let log = log(Some(Confirmed), Some(standing), Some(A));
        assert_eq!(
            runs(choose(&log, &verified(GOOD), false)),
            Some((B, Some(tries)))
        );
    }
    let image = header(B).image_id();
    assert_eq!(
        choose(
            &log(Some(Confirmed), Some(Trial(3)), Some(A)),
            &verified(GOOD),
            false
        ),
        Step::Reject(Record::Rejected { slot: B, image })
    );
    let after = log(Some(Confirmed), Some(Rejected), Some(A));
    assert_eq!(
        runs(choose(&after, &verified(GOOD), false)),
        Some((A, None))
    );
}

/// An update sent to a device whose own image has not confirmed itself yet: the new one is tried first, whichever slot it is in.
#[test]
fn of_two_unconfirmed_images_the_one_installed_last_is_tried_first() {
    for newest in SlotName::ALL {
        for (standing, tries) in [(Pending, 1), (Trial(1), 2)] {
            let mut log = log(Some(Trial(1)), Some(Trial(1)), None);
            log.slots[newest.index()] = Some((header(newest).image_id(), standing));
            log.installed_last = Some(newest);
            let next = choose(&log, &verified(GOOD), false);
            assert_eq!(runs(next), Some((newest, Some(tries))));
            // Once it is rejected, the other goes on with its own tries.
            log.slots[newest.index()] = Some((header(newest).image_id(), Rejected));
            let next = choose(&log, &verified(GOOD), false);
            assert_eq!(runs(next), Some((newest.other(), Some(2))));
        }
    }
}

#[test]
fn a_power_cut_costs_no_try() {
    for tries in 1..=3 {
        let log = log(Some(Confirmed), Some(Trial(tries)), Some(A));
        assert_eq!(runs(choose(&log, &verified(GOOD), true)), Some((B, None)));
    }
    let pending = log(Some(Confirmed), Some(Pending), Some(A));
    assert_eq!(
        runs(choose(&pending, &verified(GOOD), true)),
        Some((B, Some(1)))
    );
}

#[test]
fn of_two_confirmed_images_the_last_one_runs_and_a_damaged_one_never() {
    for last in SlotName::ALL {
        let log = log(Some(Confirmed), Some(Confirmed), Some(last));
        assert_eq!(
            runs(choose(&log, &verified(GOOD), false)),
            Some((last, None))
        );
        let mut good = GOOD;
        good[last.index()] = false;
        assert_eq!(
            runs(choose(&log, &verified(good), false)),
            Some((last.other(), None))
        );
    }
}

#[test]
fn a_damaged_image_on_trial_is_passed_over() {
    let log = log(Some(Confirmed), Some(Pending), Some(A));
    assert_eq!(
        runs(choose(&log, &verified([true, false]), false)),
        Some((A, None))
    );
}

#[test]
fn an_image_flashed_by_hand_runs_on_trial_unless_another_is_confirmed() {
    let nothing = log(None, None, None);
    assert_eq!(
        runs(choose(&nothing, &verified(GOOD), true)),
        Some((A, Some(1)))
    );
    assert_eq!(
        runs(choose(&nothing, &verified([false, true]), true)),
        Some((B, Some(1)))
    );
    let other = log(None, Some(Confirmed), Some(B));
    assert_eq!(runs(choose(&other, &verified(GOOD), true)), Some((B, None)));
}

#[test]
fn without_an_image_the_bootloader_stays_and_tells_the_better_reason() {
    let nothing = log(None, None, None);
    let erased = Err(Refusal::Header(HeaderError::Erased));
    let broken = Err(Refusal::ImageHash);
    for (slots, reason) in [
        ([erased, erased], Refusal::Header(HeaderError::Erased)),
        ([broken, erased], Refusal::ImageHash),
        ([erased, broken], Refusal::ImageHash),
    ] {
        assert_eq!(choose(&nothing, &slots, true), Step::Stay(reason));
    }
    let used_up = log(Some(Rejected), None, None);
    assert_eq!(
        choose(&used_up, &verified([true, false]), true),
        Step::Stay(Refusal::Rejected)
    );
}

/// Over every pair of standings: an update never overwrites the only confirmed image, nor the one that would run.
#[test]
fn an_update_never_overwrites_what_works() {
    let standings = [
        None,
        Some(Pending),
        Some(Trial(2)),
        Some(Confirmed),
        Some(Rejected),
    ];
    for a in standings {
        for b in standings {
            for last in [None, Some(A), Some(B)] {
                for good in [GOOD, [true, false], [false, true]] {
                    let (log, slots) = (log(a, b, last), verified(good));
                    let target = update_target(&log, &slots);
                    let works = |slot: SlotName| {
                        good[slot.index()] && [a, b][slot.index()] == Some(Confirmed)
                    };
                    if works(target) {
                        assert!(works(target.other()), "{log:?} {good:?}");
                        assert_ne!(last.unwrap_or(A), target, "{log:?}");
                    }
                    // Where nothing is confirmed, what runs now stays.
                    if !works(A)
                        && !works(B)
                        && let Some((runs, _)) = runs(choose(&log, &slots, true))
                    {
                        assert_ne!(runs, target, "{log:?} {good:?}");
                    }
                }
            }
        }
    }
}
