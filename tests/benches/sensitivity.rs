//! The sensitivity table: frames decoded of 150 in every simulated scene, native engine, each slicer. `--save` renews the committed file, against which
//! `tests/tests/sensitivity.rs` holds a few of its rows.

use tests::Bench;
use tests::reception::table;

fn main() -> std::io::Result<()> {
    if !tests::is_bench() {
        return Ok(());
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
    bench.finish(&format!("points={points} frames={}", table::FRAMES))
}
