//! The bootloader's times and stack (`tests::boot_timing`), printed with their limits.

use std::process::ExitCode;

use tests::Bench;
use tests::boot_timing::{ALL, Row};

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    let mut bench = Bench::new("boot-timing", "what,measured,unit,least,most");
    let mut held = 0;
    for measurement in ALL {
        let row = measurement.row();
        let Row {
            what,
            measured,
            unit,
            limits: (least, most),
        } = row;
        bench.line(&format!(
            "{what:<54}{measured:>9.0} {unit:<6} limits {least} to {most}"
        ));
        bench.row(format!("{what},{measured},{unit},{least},{most}"));
        held += usize::from(row.holds());
    }
    match bench.finish(&format!("held={held} of={}", ALL.len())) {
        Ok(()) if held == ALL.len() => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    }
}
