//! How far a transfer is: a bar on a terminal, a line every tenth elsewhere.

use std::io::{IsTerminal, Write};

/// Characters of the bar.
const WIDTH: usize = 40;

/// The bar.
pub struct Progress {
    total: usize,
    on_terminal: bool,
    tenth: usize,
    shown: usize,
}

impl Progress {
    /// Of `total` bytes, on standard error.
    pub fn new(total: usize) -> Self {
        Self {
            total: total.max(1),
            on_terminal: std::io::stderr().is_terminal(),
            tenth: 0,
            shown: usize::MAX,
        }
    }

    /// So many are across, since `ms`.
    pub fn at(&mut self, bytes: usize, ms: u64) {
        let percent = 100 * bytes / self.total;
        let (kib, of) = (bytes / 1024, self.total / 1024);
        let rate = bytes as u64 * 1000 / 1024 / ms.max(1);
        if !self.on_terminal {
            if percent / 10 > self.tenth {
                self.tenth = percent / 10;
                eprintln!("{percent} %  {kib} of {of} KiB  {rate} KiB/s");
            }
            return;
        }
        if percent == self.shown {
            return;
        }
        self.shown = percent;
        let bar = bar(bytes, self.total);
        // What cannot be shown does not stop the transfer.
        let mut out = std::io::stderr().lock();
        let _ = write!(
            out,
            "\r[{bar}] {percent:>3} %  {kib} of {of} KiB  {rate} KiB/s "
        );
        let _ = if bytes >= self.total {
            writeln!(out)
        } else {
            out.flush()
        };
    }
}

fn bar(bytes: usize, total: usize) -> String {
    let full = (WIDTH * bytes / total).min(WIDTH);
    "#".repeat(full) + &"-".repeat(WIDTH - full)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_is_empty_half_and_full() {
        assert_eq!(bar(0, 100), "-".repeat(40));
        assert_eq!(bar(50, 100), "#".repeat(20) + &"-".repeat(20));
        assert_eq!(bar(100, 100), "#".repeat(40));
    }
}
