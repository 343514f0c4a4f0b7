//! The bootloader's times and stack (`tests::boot_timing`), printed with their limits.

use std::process::ExitCode;

use tests::Bench;

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    let mut bench = Bench::new("boot-timing", "what,measured,unit,least,most");
    let rows = tests::boot_timing::rows();
    for row in &rows {
        let (least, most) = row.limits;
        bench.line(&format!(
            "{:<54}{:>9.0} {:<6} limits {least} to {most}",
            row.what, row.measured, row.unit
        ));
        bench.row(format!(
            "{},{},{},{least},{most}",
            row.what, row.measured, row.unit
        ));
    }
    let held = rows.iter().filter(|row| row.holds()).count();
    match bench.finish(&format!("held={held} of={}", rows.len())) {
        Ok(()) if held == rows.len() => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    }
}
