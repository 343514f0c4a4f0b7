//! Part of `cargo xtask bench twin-peers`: the peer images in the twin and in `rp2040js`.
//!
//!     image_peer <folder of images> <folder with node_modules> [<image>…]
//!
//! Prints a table and, last, `result: compared=… agreed=… accepted=… unexplained=…`; fails when something is unexplained.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use tests::image_peer::{Accepted, SCENARIOS, find_node, run};

fn main() -> ExitCode {
    match compare() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(reason) => {
            eprintln!("image_peer: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn compare() -> Result<bool, String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [images, packages, chosen @ ..] = arguments.as_slice() else {
        return Err(
            "two folders are needed: the images, and the one that holds node_modules".into(),
        );
    };
    let (images, packages) = (PathBuf::from(images), PathBuf::from(packages));
    let version = find_node()?;
    let accepted = Accepted::read()?;
    println!("peer: rp2040js in node {version}");
    println!(
        "{:<10}{:>10}{:>10}{:>10}{:>13}",
        "image", "compared", "agreed", "accepted", "unexplained"
    );
    let (mut totals, mut amended, mut reasons) = ([0; 3], BTreeMap::new(), Vec::new());
    let whole = chosen.is_empty();
    for scenario in SCENARIOS {
        if !whole && !chosen.iter().any(|image| image == scenario.image) {
            continue;
        }
        let outcome = run(scenario, &images, &packages, &accepted)?;
        let counts = [outcome.compared, outcome.agreed, outcome.accepted];
        let unexplained = outcome.unexplained.len();
        println!(
            "{:<10}{:>10}{:>10}{:>10}{unexplained:>13}",
            scenario.image, counts[0], counts[1], counts[2]
        );
        for (total, count) in totals.iter_mut().zip(counts) {
            *total += count;
        }
        for (name, count) in &outcome.amended {
            *amended.entry(name.clone()).or_insert(0) += count;
        }
        let named = outcome.unexplained.into_iter();
        reasons.extend(named.map(|text| format!("{}: {text}", scenario.image)));
    }
    println!("\n{:<22}{:>10}", "accepted, amended", "times");
    for (name, reason) in &accepted.0 {
        let times = amended.get(name).copied().unwrap_or(0);
        println!("{name:<22}{times:>10}   {reason}");
        if whole && times == 0 {
            reasons.push(format!("the line {name} of the table was never needed"));
        }
    }
    for reason in &reasons {
        println!("unexplained: {reason}");
    }
    println!(
        "result: compared={} agreed={} accepted={} unexplained={}",
        totals[0],
        totals[1],
        totals[2],
        reasons.len()
    );
    Ok(reasons.is_empty())
}
