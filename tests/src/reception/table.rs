//! The sensitivity table: every simulated scene through the native engine, behind each slicer. All of it follows from seeds, so the same code gives
//! the same text, and a change of reception shows as a change of the committed file.

use super::native::{self, Rendered, SLICERS};
use super::points::{self, Point};
use super::score::score;
use std::fmt::Write;
use twin::source::scene::wave;

/// Wanted frames a point.
pub const FRAMES: usize = 150;
/// Where the table is committed, from the checkout's root.
pub const FILE: &str = "docs/bench/sensitivity.txt";

/// The heading of the rows.
pub fn heading() -> String {
    let mut line = format!("{:<24}", "");
    for (name, _) in SLICERS {
        let _ = write!(line, "{name:>8}{:>8}{:>5}", "second", "inv");
    }
    line
}

/// A point's row: frames decoded behind each slicer, second frames of overlaps, and frames that nobody sent.
pub fn row(point: &Point) -> String {
    let scene = point.traffic.scene();
    let noise_dbm = scene.noise_dbm.unwrap_or(f32::NEG_INFINITY);
    let level = Rendered::of(&mut scene.wave(wave::STEP_PS));
    let mut line = format!("{:<24}", point.name);
    for (_, slicer) in SLICERS {
        let score = score(&scene, &native::run(&level, slicer, noise_dbm).0);
        let second = match score.overlapping {
            0 => "-".to_string(),
            _ => score.overlapping_decoded.to_string(),
        };
        let _ = write!(line, "{:>8}{second:>8}{:>5}", score.decoded, score.invented);
    }
    line
}

/// The points of the table.
pub fn points() -> Vec<Point> {
    points::all(FRAMES)
}
