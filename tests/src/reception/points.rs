//! The simulated scenes that are measured, and the shares that the prototype study gives for such scenes (its levels and its scenes were its own).

use twin::source::scene::Tolerances;
use twin::source::scene::traffic::{Overlap, Range, Traffic};

/// A scene and how it is named in the tables.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub name: &'static str,
    pub traffic: Traffic,
    /// Share of the wanted frames that readsb decoded in the prototype study, where it has such a point.
    pub readsb: Option<f64>,
}

/// Ratio to the noise in 2 MHz of the frames that meet other trouble than noise, dB.
pub const CLEAR_SNR_DB: f32 = 20.0;
/// Ratio at which the tolerances are tried: just above the noise.
pub const WEAK_SNR_DB: f32 = 14.0;
/// Mode A/C replies are between these two, dB.
pub const MODE_AC_SNR_DB: Range = Range::new(0.0, 30.0);

/// The ratios of the noise series, dB, and readsb's share.
const NOISE: [(&str, f32, Option<f64>); 16] = [
    ("snr 8", 8.0, None),
    ("snr 9", 9.0, None),
    ("snr 10", 10.0, None),
    ("snr 11", 11.0, None),
    ("snr 12", 12.0, Some(0.59)),
    ("snr 13", 13.0, None),
    ("snr 14", 14.0, Some(0.89)),
    ("snr 15", 15.0, None),
    ("snr 16", 16.0, Some(0.98)),
    ("snr 18", 18.0, None),
    ("snr 20", 20.0, Some(1.0)),
    ("snr 22", 22.0, None),
    ("snr 24", 24.0, None),
    ("snr 26", 26.0, None),
    ("snr 28", 28.0, None),
    ("snr 30", 30.0, None),
];

/// Mode A/C replies a second.
const MODE_AC: [(&str, f64, Option<f64>); 3] = [
    ("mode ac 10k", 10_000.0, Some(0.73)),
    ("mode ac 20k", 20_000.0, None),
    ("mode ac 40k", 40_000.0, Some(0.17)),
];

/// Share overlapped of each wanted frame, and names by the second frame's level.
const OVERLAPS: [(f32, [&str; 5]); 5] = [
    (
        0.0,
        [
            "overlap 0 % -10 dB",
            "overlap 0 % -5 dB",
            "overlap 0 % 0 dB",
            "overlap 0 % +5 dB",
            "overlap 0 % +10 dB",
        ],
    ),
    (
        0.25,
        [
            "overlap 25 % -10 dB",
            "overlap 25 % -5 dB",
            "overlap 25 % 0 dB",
            "overlap 25 % +5 dB",
            "overlap 25 % +10 dB",
        ],
    ),
    (
        0.5,
        [
            "overlap 50 % -10 dB",
            "overlap 50 % -5 dB",
            "overlap 50 % 0 dB",
            "overlap 50 % +5 dB",
            "overlap 50 % +10 dB",
        ],
    ),
    (
        0.75,
        [
            "overlap 75 % -10 dB",
            "overlap 75 % -5 dB",
            "overlap 75 % 0 dB",
            "overlap 75 % +5 dB",
            "overlap 75 % +10 dB",
        ],
    ),
    (
        1.0,
        [
            "overlap 100 % -10 dB",
            "overlap 100 % -5 dB",
            "overlap 100 % 0 dB",
            "overlap 100 % +5 dB",
            "overlap 100 % +10 dB",
        ],
    ),
];
/// The second frame's level over the first's, dB.
const OVERLAP_DB: [f32; 5] = [-10.0, -5.0, 0.0, 5.0, 10.0];
/// A second frame at the same time as the first starts within so much of it, as a share of the frame: two transmitters are never that exact.
const NEAR: f32 = 0.01;

/// Every point, with so many wanted frames each.
pub fn all(frames: usize) -> Vec<Point> {
    let base = Traffic {
        frames,
        ..Traffic::default()
    };
    let mut points = Vec::new();
    let mut add = |name, readsb, traffic: Traffic| {
        // Every point has other frames and other noise.
        let seed = 1090 + points.len() as u64;
        points.push(Point {
            name,
            traffic: Traffic { seed, ..traffic },
            readsb,
        });
    };
    for (name, snr_db, readsb) in NOISE {
        let snr_db = Range::at(snr_db);
        add(name, readsb, Traffic { snr_db, ..base });
    }
    for (name, mode_ac_hz, readsb) in MODE_AC {
        let traffic = Traffic {
            mode_ac_hz,
            mode_ac_snr_db: MODE_AC_SNR_DB,
            snr_db: Range::at(CLEAR_SNR_DB),
            ..base
        };
        add(name, readsb, traffic);
    }
    let nominal = Tolerances::NOMINAL;
    for (name, tolerances) in [
        (
            "carrier -1 MHz",
            Tolerances {
                carrier_hz: (-1e6, -1e6),
                ..nominal
            },
        ),
        (
            "carrier +1 MHz",
            Tolerances {
                carrier_hz: (1e6, 1e6),
                ..nominal
            },
        ),
        (
            "clock -50 ppm",
            Tolerances {
                clock_ppm: (-50.0, -50.0),
                ..nominal
            },
        ),
        (
            "clock +50 ppm",
            Tolerances {
                clock_ppm: (50.0, 50.0),
                ..nominal
            },
        ),
        ("annex 10 pulses", Tolerances::ANNEX_10),
    ] {
        let snr_db = Range::at(WEAK_SNR_DB);
        add(
            name,
            None,
            Traffic {
                tolerances,
                snr_db,
                ..base
            },
        );
    }
    let overlapping = |share, db| Traffic {
        overlap: Some(Overlap { share, db }),
        snr_db: Range::at(CLEAR_SNR_DB),
        spacing_ps: 450_000_000,
        ..base
    };
    let any = overlapping(Range::new(0.0, 1.0), Range::new(-10.0, 10.0));
    add("always overlapped", Some(0.30), any);
    for (share, names) in OVERLAPS {
        let share = if share == 1.0 {
            Range::new(1.0 - NEAR, 1.0)
        } else {
            Range::at(share)
        };
        for (name, db) in names.into_iter().zip(OVERLAP_DB) {
            add(name, None, overlapping(share, Range::at(db)));
        }
    }
    points
}

/// The ratio at which half of the frames are decoded: on the straight line between the two points of the noise series around it, dB.
pub fn half_point_db(series: &[(f64, f64)]) -> Option<f64> {
    series.windows(2).find_map(|pair| {
        let [(low_db, low), (high_db, high)] = [pair[0], pair[1]];
        (low < 0.5 && high >= 0.5).then(|| low_db + (0.5 - low) / (high - low) * (high_db - low_db))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_is_found_between_two_points() {
        let series = [(8.0, 0.0), (10.0, 0.25), (12.0, 0.75), (14.0, 1.0)];
        assert_eq!(half_point_db(&series), Some(11.0));
        assert_eq!(half_point_db(&series[..2]), None);
    }

    #[test]
    fn names_and_seeds_differ() {
        let points = all(1);
        let names: std::collections::HashSet<&str> = points.iter().map(|p| p.name).collect();
        let seeds: std::collections::HashSet<u64> = points.iter().map(|p| p.traffic.seed).collect();
        assert_eq!((names.len(), seeds.len()), (points.len(), points.len()));
    }
}
