//! For tests: a parabola by least squares in floating point.

use std::vec::Vec;

/// Place, rate and drift at the last of these values, one a second.
pub(crate) fn parabola(values: &[i64]) -> [f64; 3] {
    let n = values.len();
    let x: Vec<f64> = (0..n).map(|i| i as f64 - (n as f64 - 1.0)).collect();
    let mut sums = [0.0; 5];
    let mut right = [0.0; 3];
    for (x, &y) in x.iter().zip(values) {
        for (power, sum) in sums.iter_mut().enumerate() {
            *sum += x.powi(power as i32);
        }
        for (power, sum) in right.iter_mut().enumerate() {
            *sum += x.powi(power as i32) * y as f64;
        }
    }
    let mut rows = [0, 1, 2].map(|r| [sums[r], sums[r + 1], sums[r + 2], right[r]]);
    for column in 0..3 {
        let pivot = rows[column];
        for (r, row) in rows.iter_mut().enumerate() {
            if r != column {
                let factor = row[column] / pivot[column];
                for (value, from) in row.iter_mut().zip(pivot) {
                    *value -= factor * from;
                }
            }
        }
    }
    let [a, b, c] = [0, 1, 2].map(|i| rows[i][3] / rows[i][i]);
    [a, b, 2.0 * c]
}
