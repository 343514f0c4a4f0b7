//! Reception: the recordings of others, fairly counted, and simulated scenes, beside dump1090-mutability on the same air.
//!
//! `--short`: fewer frames a point, the native engine alone. Otherwise the board's own slicer is also heard by the shipped image in the twin.
//! `--points TEXT`: only the points whose name contains it. `--floor DB`: the trigger level of the slicers that have a floor, over the noise in 8 MHz.

use std::process::ExitCode;

use tests::Bench;
use tests::reception::device::Device;
use tests::reception::native::{Rendered, SLICERS};
use tests::reception::recordings::{Clip, DENSE, MODES1};
use tests::reception::score::{Score, score};
use tests::reception::{Decoded, fair, mutability, native, points};
use twin::front_end::{FrontEnd, Player, Slicer};
use twin::source::Format;
use twin::source::scene::{Scene, record, wave};

/// Wanted frames a point.
const FRAMES: usize = 400;
const FRAMES_SHORT: usize = 150;

fn main() -> ExitCode {
    // `cargo test --benches` only wants to see it build.
    if !std::env::args().any(|a| a == "--bench") {
        return ExitCode::SUCCESS;
    }
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("reception: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    mutability::find()?;
    let short = std::env::args().any(|a| a == "--short");
    let frames = if short { FRAMES_SHORT } else { FRAMES };
    let mut device = (!short).then(Device::start);
    let mut bench = Bench::new("reception", "what,decoder,wanted,decoded,share,invented");
    let recordings = recordings(&mut bench, &mut device)?;
    let half = scenes(&mut bench, &mut device, frames)?;
    bench
        .finish(&format!("{recordings} {half}"))
        .map_err(|error| error.to_string())
}

fn folder() -> Result<std::path::PathBuf, String> {
    let folder = tests::root().join("target/bench/reception");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(folder)
}

/// What a slicer and the native engine make of a level.
fn heard(level: &Rendered, slicer: Slicer, noise_dbm: f32) -> Vec<Decoded> {
    let floor_db = tests::number_option("--floor", native::FLOOR_OVER_NOISE_DB);
    let trigger_level_mv = native::trigger_level_mv(slicer, noise_dbm, floor_db);
    native::run_at(level, slicer, trigger_level_mv).0
}

/// Counts of one recording by each decoder: the slicers natively, the device, the peer.
struct Counts {
    native: Vec<usize>,
    device: Option<usize>,
    peer: usize,
}

fn clip(clip: &Clip, device: &mut Option<Device>) -> Result<Counts, String> {
    let mut recording = clip.open();
    let noise_dbm = recording.noise_dbm();
    let level = Rendered::of(&mut recording);
    let native = SLICERS
        .iter()
        .map(|(_, slicer)| fair::count(&heard(&level, *slicer, noise_dbm)))
        .collect();
    let device = device.as_mut().map(|device| {
        let player = Player::new(level.clone(), &FrontEnd::ADSBEE_1090);
        fair::count(&device.play(Box::new(player)))
    });
    let file = clip.for_peer(&folder()?).map_err(|e| e.to_string())?;
    let peer = fair::count(&mutability::decode(&file, "SC16")?);
    Ok(Counts {
        native,
        device,
        peer,
    })
}

fn recordings(bench: &mut Bench, device: &mut Option<Device>) -> Result<String, String> {
    bench.line("recordings: frames, fairly counted");
    bench.line(&format!(
        "{:<24}{:>8}{:>8}{:>8}{:>8}{:>12}",
        "", "rc", "peak", "fixed", "twin rc", "mutability"
    ));
    let mut all = Vec::new();
    for one in std::iter::once(&MODES1).chain(&DENSE) {
        let counts = clip(one, device)?;
        let twin = counts.device.map_or("-".into(), |n| n.to_string());
        let [rc, peak, fixed] = [0, 1, 2].map(|n| counts.native[n]);
        bench.line(&format!(
            "{:<24}{rc:>8}{peak:>8}{fixed:>8}{twin:>8}{:>12}",
            one.name, counts.peer
        ));
        let names = SLICERS.iter().map(|(name, _)| *name);
        for (name, count) in names
            .zip(&counts.native)
            .chain([("mutability", &counts.peer)])
        {
            bench.row(format!("{},{name},,{count},,", one.name));
        }
        if let Some(count) = counts.device {
            bench.row(format!("{},twin rc,,{count},,", one.name));
        }
        all.push(counts);
    }
    bench.line("");
    let sum = |of: &dyn Fn(&Counts) -> usize| all[1..].iter().map(of).sum::<usize>();
    Ok(format!(
        "modes1={} mutability={} dense={} dense_mutability={} modes1_peak={} dense_peak={}",
        all[0].native[0],
        all[0].peer,
        sum(&|c| c.native[0]),
        sum(&|c| c.peer),
        all[0].native[1],
        sum(&|c| c.native[1]),
    ))
}

fn peer(scene: &Scene, name: &str) -> Result<Score, String> {
    let path = folder()?.join(format!("{}.cu8", name.replace([' ', '%', '+'], "_")));
    let options = record::Options {
        format: Format::Cu8,
        rate_hz: mutability::RATE_HZ,
        full_scale_dbm: None,
    };
    let file = std::fs::File::create(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    record::write(scene, &options, &mut std::io::BufWriter::new(file))
        .map_err(|e| e.to_string())?;
    let heard = mutability::decode(&path, "UC8")?;
    std::fs::remove_file(&path).map_err(|e| e.to_string())?;
    Ok(score(scene, &heard))
}

fn scenes(bench: &mut Bench, device: &mut Option<Device>, frames: usize) -> Result<String, String> {
    bench.line(&format!(
        "simulated scenes: share decoded of {frames} DF17; path 8 MHz wide, signal-to-noise ratio in 2 MHz"
    ));
    bench.line(&format!(
        "{:<24}{:>8}{:>8}{:>8}{:>8}{:>12}{:>8}",
        "", "rc", "peak", "fixed", "twin rc", "mutability", "readsb*"
    ));
    let only = tests::option("--points");
    let mut noise: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut invented = [0; 5];
    for point in points::all(frames) {
        if only
            .as_ref()
            .is_some_and(|text| !point.name.contains(text.as_str()))
        {
            continue;
        }
        let scene = point.traffic.scene();
        let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
        let level = Rendered::of(&mut scene.wave(wave::STEP_PS));
        let mut scores: Vec<Option<Score>> = SLICERS
            .iter()
            .map(|(_, slicer)| Some(score(&scene, &heard(&level, *slicer, noise_dbm))))
            .collect();
        scores.push(device.as_mut().map(|device| {
            let player = Player::new(level.clone(), &FrontEnd::ADSBEE_1090);
            score(&scene, &device.play(Box::new(player)))
        }));
        scores.push(Some(peer(&scene, point.name)?));
        row(bench, &point, &scores, &Score::share, "");
        if point.traffic.overlap.is_some() {
            row(
                bench,
                &point,
                &scores,
                &Score::share_overlapping,
                "  second frame",
            );
        }
        for (sum, score) in invented.iter_mut().zip(&scores) {
            *sum += score.map_or(0, |score| score.invented);
        }
        if point.name.starts_with("snr") {
            let shares = scores
                .iter()
                .map(|s| s.map_or(0.0, |s| s.share()))
                .collect();
            noise.push((f64::from(point.traffic.snr_db.from), shares));
        }
    }
    bench.line("* readsb's shares in the prototype study, on scenes of its own");
    bench.line(&format!(
        "frames that nobody sent: rc, peak, fixed, twin rc, mutability {invented:?}"
    ));
    let half = |column: usize| {
        let series: Vec<(f64, f64)> = noise.iter().map(|(db, s)| (*db, s[column])).collect();
        points::half_point_db(&series).map_or("none".into(), |db| format!("{db:.1}"))
    };
    bench.line(&format!(
        "half decoded at, dB: rc {}, peak {}, fixed {}, twin rc {}, mutability {}",
        half(0),
        half(1),
        half(2),
        half(3),
        half(4)
    ));
    Ok(format!(
        "half_rc={} half_peak={} half_fixed={} half_mutability={}",
        half(0),
        half(1),
        half(2),
        half(4)
    ))
}

fn row(
    bench: &mut Bench,
    point: &points::Point,
    scores: &[Option<Score>],
    share: &dyn Fn(&Score) -> f64,
    suffix: &str,
) {
    let cell = |score: &Option<Score>| {
        score.map_or("-".to_string(), |score| format!("{:.3}", share(&score)))
    };
    let cells: Vec<String> = scores.iter().map(cell).collect();
    let readsb = match (suffix, point.readsb) {
        ("", Some(share)) => format!("{share:.2}"),
        _ => String::new(),
    };
    let name = if suffix.is_empty() {
        point.name
    } else {
        suffix
    };
    bench.line(&format!(
        "{name:<24}{:>8}{:>8}{:>8}{:>8}{:>12}{readsb:>8}",
        cells[0], cells[1], cells[2], cells[3], cells[4]
    ));
    let decoders = SLICERS
        .iter()
        .map(|(name, _)| *name)
        .chain(["twin rc", "mutability"]);
    for (decoder, score) in decoders.zip(scores) {
        if let Some(score) = score {
            bench.row(format!(
                "{}{suffix},{decoder},{},{},{:.4},{}",
                point.name,
                score.wanted,
                score.decoded,
                share(score),
                score.invented
            ));
        }
    }
}
