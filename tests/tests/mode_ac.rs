//! Mode A/C replies on the shipped image: pulses on the pin, messages on the console.

use std::sync::Arc;

use tests::reception::device::{Device, counter};
use tests::reception::mode_ac::{self, Heard};
use tests::reception::score::score;
use twin::beast_stream::Reader;
use twin::front_end::{FrontEnd, Player};
use twin::source::scene::traffic::{Range, Traffic};
use twin::source::scene::{Content, Emission, Role, Scene, dbm_at_snr, wave};

/// Replies on the air, and picoseconds from one to the next: no whole number of samples.
const REPLIES: u64 = 200;
const SPACING_PS: u64 = 100_031_000;
/// Their ratio to the noise, dB.
const SNR_DB: f32 = 25.0;
/// Core 0 tells core 1 of a changed wish within a beat of 50 ms.
const BEAT_MS: u64 = 60;
/// The last reply is out after this, ms.
const TAIL_MS: u64 = 3;
/// 12 MHz counts from F1 to F2, 20.3 us, which the stamp names, and picoseconds of twelve counts.
const F2_COUNTS: i64 = 244;
const TWELVE_COUNTS_PS: i64 = 1_000_000;

/// Strong replies one by one in silence, every seventh with the identification pulse.
fn air() -> Scene {
    let emission = |number: u64| Emission {
        at_ps: number * SPACING_PS,
        transmitter: number as usize,
        dbm: dbm_at_snr(SNR_DB),
        content: Content::ModeAc {
            code: (number * 1_237 % 4096) as u16,
            spi: number.is_multiple_of(7),
        },
        role: Role::Wanted,
    };
    let quiet = Traffic {
        frames: 0,
        noise: false,
        ..Traffic::default()
    };
    Scene {
        emissions: Arc::new((0..REPLIES).map(emission).collect()),
        length_ps: REPLIES * SPACING_PS,
        ..quiet.scene()
    }
}

/// Plays the air into the device; replies that it told in Beast.
fn play(device: &mut Device, scene: &Scene) -> Vec<Heard> {
    device.run_ms(BEAT_MS);
    let player = Player::new(scene.wave(wave::STEP_PS), &FrontEnd::ADSBEE_1090);
    let playback = device.play_on(Box::new(player));
    while !device.board.playback_finished() {
        device.collect(playback, 1);
    }
    device.collect(playback, TAIL_MS);
    let messages = Reader::default().read(&device.said);
    let replies = messages.iter().filter(|message| message.bytes.len() == 2);
    let heard = replies.map(|message| {
        let bits = u16::from_be_bytes([message.bytes[0], message.bytes[1]]);
        let digits = [bits >> 12, bits >> 8, bits >> 4, bits].map(|digit| digit & 7);
        let counts = message.stamp as i64 - F2_COUNTS - playback.start_tick as i64 / 10;
        Heard {
            at_ps: counts * TWELVE_COUNTS_PS / 12,
            code: digits.iter().fold(0, |code, digit| code << 3 | digit),
            spi: bits & 0x80 != 0,
        }
    });
    heard.collect()
}

fn grown(before: &str, after: &str, stage: &str, name: &str) -> u64 {
    let count = |stats| counter(stats, stage, name).unwrap_or_else(|| panic!("no {name}: {stats}"));
    count(after) - count(before)
}

#[test]
fn replies_come_out_when_they_are_asked_for() {
    let scene = air();
    let mut device = Device::start();
    let before = device.stats();
    assert_eq!(play(&mut device, &scene), [], "nobody asked");
    let unasked = device.stats();
    assert_eq!(grown(&before, &unasked, "MODE_AC", "reply_words"), 0);
    assert_eq!(grown(&before, &unasked, "QUEUE", "replies_queued"), 0);

    device.board.console_write(b"\x1a1J");
    let heard = play(&mut device, &scene);
    let after = device.stats();
    let most = REPLIES * 9 / 10;
    for (stage, name) in [("MODE_AC", "replies"), ("QUEUE", "replies_queued")] {
        assert!(grown(&unasked, &after, stage, name) >= most, "{after}");
    }
    let result = mode_ac::score(&scene, &heard);
    assert!(result.decoded as u64 >= most, "{result:?}");
    assert!(result.wrong + result.invented <= 4, "{result:?}");
    let with_spi = heard.iter().filter(|reply| reply.spi).count();
    assert!(with_spi >= 20, "{heard:?}");

    device.board.console_write(b"\x1a1j");
    assert_eq!(play(&mut device, &scene), [], "asked no longer");

    // Text tells replies as four octal digits where all is asked for; the identification pulse has no place there.
    device.ask("AT+PROTOCOL=CONSOLE,HEX");
    play(&mut device, &scene);
    assert!(!told_lines(&device.said).any(|_| true), "nobody asked");
    device.ask("AT+RAW_FILTER=0");
    play(&mut device, &scene);
    let said = String::from_utf8_lossy(&device.said).into_owned();
    let is_told = |emission: &&Emission| match emission.content {
        Content::ModeAc { code, .. } => said.contains(&format!("*{code:04o};(")),
        Content::ModeS(_) => false,
    };
    let told = scene.emissions.iter().filter(is_told).count() as u64;
    assert!(told >= most, "{told}: {said}");
    let lines = told_lines(&device.said).count();
    assert!(lines as u64 <= REPLIES + 4, "{said}");
    // Half of them met a conversion of the level.
    let levels = told_lines(&device.said)
        .filter(|line| line.contains(";(-"))
        .count();
    assert!(levels > lines / 4 && levels < lines, "{levels} of {lines}");

    // The statistics tell all replies, in the second or two in which they were.
    device.ask("AT+PROTOCOL=CONSOLE,CSBEE");
    play(&mut device, &scene);
    for _ in 0..1_100 {
        device.run_ms(1);
        let said = device.board.console_read();
        device.said.extend(said);
    }
    let said = String::from_utf8_lossy(&device.said).into_owned();
    let replies = said.lines().filter_map(|line| {
        let fields: Vec<&str> = line.strip_prefix("#S:")?.split(',').collect();
        fields.get(1)?.parse::<u64>().ok()
    });
    assert!(replies.sum::<u64>() >= most, "{said}");
}

/// Lines of HEX that tell a reply.
fn told_lines(said: &[u8]) -> impl Iterator<Item = String> {
    let lines: Vec<String> = String::from_utf8_lossy(said)
        .lines()
        .filter(|line| line.starts_with('*') && line.find(';') == Some(5))
        .map(str::to_string)
        .collect();
    lines.into_iter()
}

/// Mode S goes first: replies that are asked for cost no frame.
#[test]
fn frames_among_replies_are_as_many_when_replies_are_told() {
    let traffic = Traffic {
        frames: 60,
        snr_db: Range::at(20.0),
        mode_ac_hz: 20_000.0,
        ..Traffic::default()
    };
    let scene = traffic.scene();
    let [(without, _), (with, replies)] = [false, true].map(|asks| {
        let mut device = Device::start();
        if asks {
            device.board.console_write(b"\x1a1J");
        }
        device.run_ms(BEAT_MS);
        let player = Player::new(scene.wave(wave::STEP_PS), &FrontEnd::ADSBEE_1090);
        let heard = device.play(Box::new(player));
        let messages = Reader::default().read(&device.said);
        let replies = messages.iter().filter(|message| message.bytes.len() == 2);
        (score(&scene, &heard).decoded, replies.count())
    });
    assert!(without >= 30, "{without}");
    assert_eq!(with, without);
    assert!(replies > 0);
}
