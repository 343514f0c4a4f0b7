use std::io::Write;
use twin::front_end::*;
use twin::source::*;
struct N(noise::Noise, u64);
impl Level for N {
    fn step_ps(&self) -> u64 {
        31250
    }
    fn fill(&mut self, d: &mut [f32]) -> usize {
        if self.1 == 0 {
            return 0;
        }
        self.1 -= 1;
        self.0.fill_level(-80.0, d);
        d.len()
    }
}
fn bits(p: &mut dyn PulseSource, name: &str) {
    let mut e = vec![];
    let mut out = vec![];
    let mut u = 0;
    let mut lv = 0u8;
    while !p.finished() {
        u += 128_000_000;
        p.next_edges(u, &mut e);
        for x in e.drain(..) {
            let k = (edge_tick(x.at_ps).div_ceil(15)) as usize;
            while out.len() < k {
                out.push(lv);
            }
            lv = x.level as u8;
        }
    }
    std::fs::File::create(name)
        .unwrap()
        .write_all(&out)
        .unwrap();
}
fn main() {
    let d = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/");
    for (s, tl, n) in [
        (Slicer::RcFollowing, 1300.0, "rc"),
        (Slicer::PeakFollowing, 1100.0, "pk"),
    ] {
        let fe = FrontEnd {
            trigger_level_mv: tl,
            ..FrontEnd::with_slicer(s)
        };
        for (f, format, rate, o) in [
            ("modes1.bin", Format::Cu8, 2_000_000u64, "m1"),
            ("rsadsb-1641427457780.cs16", Format::Cs16Qi, 2_400_000, "d1"),
            ("rsadsb-old-01.iq", Format::Cu8, 2_400_000, "d2"),
        ] {
            let path = format!("{d}{f}");
            let path = std::path::Path::new(&path);
            let mk = || {
                Player::new(
                    Recording::open(path, &RecordingOptions::new(format, rate)).unwrap(),
                    &fe,
                )
            };
            bits(&mut mk(), &format!("/tmp/bits.{n}.{o}"));
            let mut t = std::fs::File::create(format!("/tmp/truth.{n}.{o}")).unwrap();
            twin::native::run(&mut mk(), Default::default(), &mut |f| {
                writeln!(t, "{} {:?}", f.arrival / 15, f.frame).unwrap();
            });
        }
        bits(
            &mut Player::new(N(noise::Noise::new(5, 32e6, 8e6), 62_500 * 2), &fe),
            &format!("/tmp/bits.{n}.noise"),
        );
    }
}
