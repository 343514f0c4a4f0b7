use twin::front_end::*;
use twin::source::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let secs: u64 = a[2].parse().unwrap();
    let tl: f64 = a[3].parse().unwrap();
    let lv: f32 = a.get(4).and_then(|s| s.parse().ok()).unwrap_or(0.0);
    let sl = match a.get(5).map(|s| s.as_str()) {
        Some("pk") => Slicer::PeakFollowing,
        Some("fix") => Slicer::Fixed,
        _ => Slicer::RcFollowing,
    };
    for noise in [Some(-102.0), None] {
        let log = MessageLog::open(std::path::Path::new(&a[1]), 4_000_000_000).unwrap();
        let mut o = AirOptions {
            until_ps: Some(secs * 1_000_000_000_000),
            noise_dbm: noise,
            ..Default::default()
        };
        if lv != 0.0 {
            o.level = SenderLevel::Fixed(lv);
        }
        let mut p = Player::new(
            Air::new(log, o),
            &FrontEnd {
                trigger_level_mv: tl,
                ..FrontEnd::with_slicer(sl)
            },
        );
        let t = std::time::Instant::now();
        let mut n = 0;
        let mut off = [0u64; 16];
        let c = twin::native::run(&mut p, Default::default(), &mut |f| {
            n += 1;
            off[(f.arrival % 16) as usize] += 1;
        });
        let el = t.elapsed().as_secs_f64();
        let s = p.source();
        println!(
            "noise {noise:?} sent {} left out {} refused {} decoded {n} ({:.3}) in {el:.2} s = {:.1}x; {:?} bal {}",
            s.sent(),
            s.left_out(),
            s.messages().refused(),
            n as f64 / s.sent() as f64,
            secs as f64 / el,
            c,
            c.balances()
        );
    }
}
