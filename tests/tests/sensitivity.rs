//! Sensitivity as committed: a few rows of the table, worked out again, are the committed ones to the last frame.
//!
//! A change of the demodulator, of the front end or of the scenes shows here; `cargo xtask bench sensitivity --save` renews the table, and the diff says
//! what became better or worse.

use tests::reception::table;

/// The rows that are held: weak, at the edge, among replies, overlapped, with tolerances.
const HELD: [&str; 6] = [
    "snr 10",
    "snr 13",
    "snr 20",
    "mode ac 40k",
    "always overlapped",
    "annex 10 pulses",
];

#[test]
fn a_few_points_give_the_committed_rows() {
    let path = tests::root().join(table::FILE);
    let committed = std::fs::read_to_string(&path)
        .unwrap_or_else(|cause| panic!("{}: {cause}", path.display()));
    let points = table::points();
    let changed: Vec<String> = HELD
        .iter()
        .filter_map(|name| {
            let point = points
                .iter()
                .find(|point| point.name == *name)
                .expect("a point");
            let row = table::row(point);
            let known = committed.lines().any(|line| line == row.trim_end());
            (!known).then_some(row)
        })
        .collect();
    assert!(
        changed.is_empty(),
        "reception changed; these rows are not in {}: \n{}\nif the change is meant: cargo xtask bench sensitivity --save",
        table::FILE,
        changed.join("\n")
    );
}

#[test]
fn no_point_of_the_committed_table_has_an_invented_frame() {
    let committed = std::fs::read_to_string(tests::root().join(table::FILE)).expect("the table");
    let mut rows = 0;
    for point in table::points() {
        let row = committed
            .lines()
            .find(|line| {
                line.get(..24)
                    .is_some_and(|name| name.trim_end() == point.name)
            })
            .unwrap_or_else(|| panic!("no row {}", point.name));
        let numbers: Vec<&str> = row[24..].split_whitespace().collect();
        assert!(numbers.chunks(3).all(|slicer| slicer[2] == "0"), "{row}");
        rows += 1;
    }
    assert!(rows > 40, "{rows} rows");
}
