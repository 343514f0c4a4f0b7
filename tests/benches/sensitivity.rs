//! The sensitivity table: frames decoded of 150 in every simulated scene, native engine, each slicer. `--save` renews the committed file, against which
//! `tests/tests/sensitivity.rs` holds a few of its rows.
//!
//! `--replies`: the Mode A/C rows alone.
//!
//! `--genie`: instead, just above the noise, where frames are lost and what could be decoded at best (`tests::reception::genie`); `--floor DB` is the height of a standing trigger
//! level over the noise, `--rc-over MV` moves the following one.
//!
//! `--evidence`: instead, what eight samples of a half bit say (`tests::reception::evidence`), beside the table that the demodulator has; `--save` renews that.

use tests::Bench;
use tests::reception::native::FLOOR_OVER_NOISE_DB;
use tests::reception::{evidence, genie, mode_ac, table};

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
    }
    if tests::flag("--replies") {
        // Alone, and not to be saved: the table is whole or not at all.
        let mut bench = Bench::new("sensitivity-replies", "row");
        replies(&mut bench);
        return bench.finish("replies alone");
    }
    if tests::flag("--genie") {
        return at_best();
    }
    if tests::flag("--evidence") {
        return learned();
    }
    let mut bench = Bench::new("sensitivity", "row");
    bench.line(&format!(
        "frames decoded of {} DF17 by slicer, second frames of overlaps, frames nobody sent",
        table::FRAMES
    ));
    bench.line(&table::heading());
    let mut points = 0;
    for point in table::points() {
        let row = table::row(&point);
        bench.line(&row);
        bench.row(row);
        points += 1;
    }
    replies(&mut bench);
    bench.finish(&format!("points={points} frames={}", table::FRAMES))
}

fn replies(bench: &mut Bench) {
    bench.line("");
    bench.line("Mode A/C replies by slicer: share decoded of all, of those 12 dB or more over the noise (clear), of these that nothing overlaps (alone); told with another code, and of nobody, a second");
    bench.line(&mode_ac::heading());
    for row in mode_ac::rows() {
        bench.line(&row);
        bench.row(row);
    }
}

/// Ratios at which the genie is asked, by the names of their points.
const WEAK: [&str; 5] = ["snr 9", "snr 10", "snr 11", "snr 12", "snr 13"];

fn at_best() -> std::io::Result<()> {
    let floor_db = tests::number_option("--floor", FLOOR_OVER_NOISE_DB);
    let rc_over_mv = tests::number_option("--rc-over", 0.0);
    let mut bench = Bench::new("sensitivity-genie", "row");
    bench.line(&genie::heading());
    let points = table::points();
    for point in points.iter().filter(|point| WEAK.contains(&point.name)) {
        for row in genie::rows(point, floor_db, rc_over_mv) {
            bench.line(&row);
            bench.row(row);
        }
    }
    bench.finish(&format!("points={} frames={}", WEAK.len(), table::FRAMES))
}

fn learned() -> std::io::Result<()> {
    let path = tests::root().join(evidence::FILE);
    let table = evidence::table();
    let numbers = |text: &str| -> Vec<i32> {
        let words = text.split([' ', ',', '\n', '[', ']']);
        words.filter_map(|word| word.parse().ok()).collect()
    };
    let (learned, known) = (numbers(&table), numbers(&std::fs::read_to_string(&path)?));
    let off = learned.iter().zip(&known).map(|(a, b)| a.abs_diff(*b));
    let equal = off.clone().filter(|off| *off == 0).count();
    print!("{table}");
    if tests::flag("--save") {
        std::fs::write(&path, table)?;
    }
    println!(
        "result: patterns={} equal={equal} most_off={}",
        learned.len(),
        off.max().unwrap_or(0)
    );
    Ok(())
}
