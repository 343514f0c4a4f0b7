//! `RAW_FILTER` on the shipped image: frames with broken bits on the air, seen in raw outputs when asked for, and by no decoder ever.

use tests::reception::device::{Device, counter};
use twin::front_end::{FrontEnd, Player};
use twin::source::scene::aircraft::address_of;
use twin::source::scene::traffic::{Range, Traffic, df11, surveillance};
use twin::source::scene::{Content, Emission, Role, Scene, dbm_at_snr, wave};

/// Frames on the air; every second one is broken.
const FRAMES: usize = 40;
/// Bits flipped in a broken one, byte and mask: three, while at most two are ever repaired.
const BROKEN: [(usize, u8); 3] = [(5, 0x01), (7, 0x10), (9, 0x04)];
/// Core 0 tells core 1 of a changed setting within a beat of 50 ms.
const BEAT_MS: u64 = 60;

/// Strong frames, and which of them are broken.
fn air() -> (Scene, Vec<mode_s::Frame>, Vec<mode_s::Frame>) {
    let mut scene = Traffic {
        frames: FRAMES,
        snr_db: Range::at(30.0),
        ..Traffic::default()
    }
    .scene();
    let mut emissions = scene.emissions.to_vec();
    let (mut whole, mut broken) = (Vec::new(), Vec::new());
    for (number, emission) in emissions.iter_mut().enumerate() {
        let Content::ModeS(frame) = &mut emission.content else {
            panic!("only frames were asked for");
        };
        if number % 2 == 1 {
            let mut bytes = frame.bytes().to_vec();
            for (at, mask) in BROKEN {
                bytes[at] ^= mask;
            }
            *frame = mode_s::Frame::from_bytes(&bytes).expect("DF is as it was");
            broken.push(*frame);
        } else {
            whole.push(*frame);
        }
    }
    scene.emissions = emissions.into();
    (scene, whole, broken)
}

/// Plays the air; what the console said.
fn play(device: &mut Device, scene: &Scene) -> Vec<Vec<u8>> {
    device.run_ms(BEAT_MS);
    let wave = scene.wave(wave::STEP_PS);
    let heard = device.play(Box::new(Player::new(wave, &FrontEnd::ADSBEE_1090)));
    heard.into_iter().map(|frame| frame.bytes).collect()
}

/// No parity tells at which phase a broken frame's bits are best: nine of ten, with not a bit else wrong.
fn is_most(count: usize, of: usize) -> bool {
    count * 10 >= of * 9
}

fn count(frames: &[mode_s::Frame], heard: &[Vec<u8>]) -> usize {
    let is_heard = |frame: &&mode_s::Frame| heard.iter().any(|bytes| bytes == frame.bytes());
    frames.iter().filter(is_heard).count()
}

fn hex_lines(frames: &[mode_s::Frame], said: &str) -> usize {
    let line = |frame: &mode_s::Frame| {
        let digits: Vec<String> = frame.bytes().iter().map(|b| format!("{b:02X}")).collect();
        format!("*{};(", digits.concat())
    };
    let is_said = |frame: &&mode_s::Frame| said.contains(&line(frame));
    frames.iter().filter(is_said).count()
}

#[test]
fn refused_frames_are_in_raw_outputs_when_asked_for_and_never_decoded() {
    let (scene, whole, broken) = air();
    let mut device = Device::start();

    let heard = play(&mut device, &scene);
    assert_eq!(count(&whole, &heard), whole.len());
    assert_eq!(count(&broken, &heard), 0, "accepted ones alone by default");
    // Not filtered out at the port alone: nobody asked, so core 1 does not work for it.
    let handed_on = |device: &mut Device| counter(&device.stats(), "DEMOD", "handed_on");
    assert_eq!(handed_on(&mut device), Some(0));

    assert!(device.ask("AT+RAW_FILTER=0").contains("OK"));
    let before = device.stats();
    let heard = play(&mut device, &scene);
    assert_eq!(count(&whole, &heard), whole.len());
    assert!(is_most(count(&broken, &heard), broken.len()));
    let after = device.stats();
    let grown = |stage, name| {
        let [before, after] = [&before, &after].map(|stats| counter(stats, stage, name));
        after.zip(before).map(|(after, before)| after - before)
    };
    assert!(grown("DECODE", "refused") >= Some(broken.len() as u64));
    assert_eq!(grown("DECODE", "broken"), Some(0), "{after}");
    assert_eq!(grown("DECODE", "offered"), grown("DEMOD", "accepted_exact"));
    assert_eq!(grown("TRACKER", "offered"), grown("DECODE", "offered"));
    assert_eq!(
        grown("DEMOD", "handed_on"),
        grown("DECODE", "refused"),
        "{after}"
    );

    device.ask("AT+PROTOCOL=CONSOLE,HEX");
    play(&mut device, &scene);
    let said = String::from_utf8_lossy(&device.said).into_owned();
    assert_eq!(hex_lines(&whole, &said), whole.len(), "{said}");
    assert!(is_most(hex_lines(&broken, &said), broken.len()), "{said}");

    assert!(device.ask("AT+RAW_FILTER=1").contains("OK"));
    device.run_ms(BEAT_MS);
    let before = handed_on(&mut device);
    device.ask("AT+PROTOCOL=CONSOLE,HEX");
    play(&mut device, &scene);
    let said = String::from_utf8_lossy(&device.said).into_owned();
    assert_eq!(hex_lines(&whole, &said), whole.len(), "{said}");
    assert_eq!(hex_lines(&broken, &said), 0, "{said}");
    assert_eq!(handed_on(&mut device), before);
}

/// A near and a far aircraft squitter; then replies with the near one's address come, one as strong as it and one as weak as the far one, and one of the far one.
fn replies_near_and_far() -> (Scene, [mode_s::Frame; 3]) {
    let [near, far] = [0, 1].map(address_of);
    let replies = [
        surveillance(5, near, 0x0A10),
        surveillance(5, near, 0x0A11),
        surveillance(5, far, 0x0A12),
    ];
    let [as_strong, too_weak, of_the_far] = replies;
    let on_air = [
        (0, 40.0, df11(near)),
        (1, 16.0, df11(far)),
        (0, 32.0, as_strong),
        (0, 16.0, too_weak),
        (1, 16.0, of_the_far),
    ];
    let emission = |(number, (transmitter, snr_db, frame))| Emission {
        at_ps: (number as u64 + 1) * 300_000_000,
        transmitter,
        dbm: dbm_at_snr(snr_db),
        content: Content::ModeS(frame),
        role: Role::Wanted,
    };
    let scene = Traffic {
        frames: on_air.len() + 1,
        ..Traffic::default()
    };
    let emissions: Vec<Emission> = on_air.into_iter().enumerate().map(emission).collect();
    let scene = Scene {
        emissions: emissions.into(),
        ..scene.scene()
    };
    (scene, replies)
}

#[test]
fn a_reply_that_is_24_db_weaker_than_its_aircraft_is_refused() {
    let (scene, [as_strong, too_weak, of_the_far]) = replies_near_and_far();
    let mut device = Device::start();
    let heard = play(&mut device, &scene);
    assert_eq!(count(&[as_strong, of_the_far], &heard), 2);
    assert_eq!(count(&[too_weak], &heard), 0);
    let stats = device.stats();
    assert_eq!(counter(&stats, "DEMOD", "unlikely"), Some(1), "{stats}");
    assert_eq!(counter(&stats, "DECODE", "address"), Some(2), "{stats}");
    // Raw outputs that ask for refused frames have it, and no decoder.
    assert!(device.ask("AT+RAW_FILTER=0").contains("OK"));
    let heard = play(&mut device, &scene);
    assert_eq!(count(&[as_strong, too_weak, of_the_far], &heard), 3);
    let stats = device.stats();
    assert_eq!(counter(&stats, "DECODE", "address"), Some(4), "{stats}");
}
