//! Whatever pulses and names come: no panic, and no later frame gets an earlier stamp.

use proptest::prelude::*;
use timebase::{Arrival, Name, Quality, Timebase};

const S: u64 = timebase::TICKS_A_SECOND;

#[derive(Clone, Debug)]
enum Event {
    Pulse(u64),
    Name(u64, Option<i32>, u32),
    Quality(Quality),
    Stamps(u64),
}

fn event() -> impl Strategy<Value = Event> {
    // Mostly a second on, with errors of every size.
    let step = prop_oneof![
        8 => (0..40u64).prop_map(|e| S - 20 + e),
        1 => 0..S * 3,
        1 => 0..S * 2_000,
    ];
    prop_oneof![
        6 => step.clone().prop_map(Event::Pulse),
        3 => (0..S, proptest::option::of(0..60_000i32), 0..86_401u32).prop_map(|(t, d, s)| Event::Name(t, d, s)),
        1 => prop_oneof![Just(Quality::Lost), Just(Quality::Silent), Just(Quality::TwoDimensions)].prop_map(Event::Quality),
        4 => (0..S).prop_map(Event::Stamps),
    ]
}

proptest! {
    #[test]
    fn stamps_of_one_second_never_go_back(
        events in proptest::collection::vec(event(), 1..120),
        start in prop_oneof![Just(0u64), 0..1u64 << 40, Just(u64::MAX >> 2)],
    ) {
        let mut base = Timebase::new();
        let mut now = start;
        for n in 0..6 {
            base.pulse(now + n * S);
        }
        now += 5 * S;
        let mut last = None;
        for event in events {
            match event {
                Event::Pulse(step) => {
                    now += step;
                    let begun = base.counters().begun;
                    base.pulse(now);
                    // A second that moved elsewhere is another count.
                    if base.counters().begun != begun {
                        last = None;
                    }
                }
                Event::Name(step, day, second_of_day) => base.name(now + step, Name { day, second_of_day }),
                Event::Quality(quality) => base.set_quality(quality),
                Event::Stamps(step) => {
                    now += step;
                    for later in 0..20 {
                        let stamp = base.stamp(Arrival::at(now + later * 7));
                        if let Some(ns) = stamp.ts1s_ns {
                            prop_assert!(ns < 1_000_000_000);
                            let (tick, before) = last.unwrap_or((now, ns));
                            // Within a half second of ticks a smaller number is either a new second or a step back.
                            let elapsed = (now + later * 7 - tick) * 25 / 3;
                            let wrapped = before as u64 + elapsed + 2_000 >= 1_000_000_000;
                            prop_assert!(ns >= before || wrapped, "{before} then {ns}");
                            last = Some((now + later * 7, ns));
                        }
                    }
                    now += 140;
                }
            }
            let _ = (base.utc(now), base.coarse(now), base.state(now), base.measured_hz(now), base.deviation_ppt());
        }
    }
}
