use twin::front_end::{FrontEnd, Player, Slicer};
use twin::source::*;
fn main() {
    let d = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/");
    let files = [
        ("modes1.bin", Format::Cu8, 2_000_000u64),
        ("rsadsb-1641427457780.cs16", Format::Cs16Qi, 2_400_000),
        ("rsadsb-old-01.iq", Format::Cu8, 2_400_000),
    ];
    let arg = std::env::args().nth(1).unwrap_or_default();
    let rcns: f32 = std::env::args()
        .nth(2)
        .and_then(|s| s.parse().ok())
        .unwrap_or(2000.0);
    for (name, format, rate) in files {
        for (slicer, tl) in [
            (Slicer::RcFollowing, 1285.0),
            (Slicer::RcFollowing, 1300.0),
            (Slicer::RcFollowing, 1315.0),
            (Slicer::PeakFollowing, 1100.0),
        ] {
            let rec = Recording::open(
                std::path::Path::new(&format!("{d}{name}")),
                &RecordingOptions::new(format, rate),
            )
            .unwrap();
            let mut fe = FrontEnd::with_slicer(slicer);
            fe.rc_ns = rcns;
            let mut p = Player::new(rec, &fe);
            let mut n = 0;
            let mut other = 0;
            let mut v = vec![];
            let c = twin::native::run(
                &mut p,
                twin::native::Options {
                    trigger_level_mv: Some(tl),
                    ..Default::default()
                },
                &mut |f| {
                    n += 1;
                    v.push((f.arrival, f.frame));
                    if let 11 | 17 | 18 = f.frame.df().number() {
                        let b = f.frame.bytes();
                        if b[1..4] != [0x4d, 0x20, 0x23] {
                            other += 1;
                        }
                    }
                },
            );
            println!(
                "{:8.8} {:6.6} {tl}: {n} (other {other}) bal {} cand {} score- {} demod {} nob {} fmt {} par {} unk {} unsure {} ex {} ic {} ap {}",
                name,
                format!("{slicer:?}"),
                c.balances(),
                c.candidates,
                c.rejected_by_score,
                c.demodulated,
                c.no_bits,
                c.bad_format,
                c.bad_parity,
                c.unknown_address,
                c.unsure,
                c.accepted_exact,
                c.accepted_interrogator,
                c.accepted_address
            );
            if arg == "list" {
                for (a, f) in v {
                    println!("{:.3} {:?}", a as f64 / 120.0 - 5000.0, f);
                }
            }
        }
    }
}
