//! Time on a processor, so that what else the machine does counts as little as can be.

use std::time::{Duration, Instant};

/// Processor time of this thread; wall time where the system does not tell.
pub struct ProcessorTime {
    used: Option<Duration>,
    wall: Instant,
}

impl ProcessorTime {
    /// From now on.
    pub fn now() -> Self {
        Self {
            used: Self::used(),
            wall: Instant::now(),
        }
    }

    /// Linux: nanoseconds on a processor, the first word.
    fn used() -> Option<Duration> {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        let ns = text.split_whitespace().next()?.parse().ok()?;
        Some(Duration::from_nanos(ns))
    }

    /// What was used since.
    pub fn elapsed(&self) -> Duration {
        match (self.used, Self::used()) {
            (Some(before), Some(now)) => now - before,
            _ => self.wall.elapsed(),
        }
    }
}
