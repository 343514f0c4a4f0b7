//! The matrix of what an update refuses (`tests::refusals`), printed with counts. Fails when a wrong package was taken.

use std::process::ExitCode;

use tests::Bench;

fn main() -> ExitCode {
    if !tests::is_bench() {
        return ExitCode::SUCCESS;
    }
    let mut bench = Bench::new("refusals", "what,packages,taken");
    bench.line(&format!(
        "{:<54}{:>9}{:>7}  reasons",
        "", "packages", "taken"
    ));
    let matrix = tests::refusals::matrix();
    for row in &matrix {
        let reasons = row
            .reasons
            .iter()
            .map(|(why, count)| format!("{why} {count}"));
        let reasons = reasons.collect::<Vec<_>>().join(", ");
        bench.line(&format!(
            "{:<54}{:>9}{:>7}  {reasons}",
            row.what, row.packages, row.taken
        ));
        bench.row(format!("{},{},{}", row.what, row.packages, row.taken));
    }
    let (good, wrong) = matrix.split_at(1);
    let (offered, taken): (u32, u32) = wrong
        .iter()
        .fold((0, 0), |sum, row| (sum.0 + row.packages, sum.1 + row.taken));
    let is_fine = good[0].taken == 1 && taken == 0;
    match bench.finish(&format!("refused={} accepted={taken}", offered - taken)) {
        Ok(()) if is_fine => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    }
}
