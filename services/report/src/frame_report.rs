//! One received frame with all that is known of its reception: what the raw protocols are given.
//!
//! ```text
//!   arrival            leading edge of the preamble's first pulse (Mode A/C: of F1), the instant every time here names
//!     + 20.3 µs        Mode A/C: F2
//!     + 64 µs          end of the first 56 bits
//!     + 64 | 120 µs    end of a short | long frame
//! ```
//! Which of these a protocol's stamp names is the protocol's matter.

use mode_s::{Frame, ModeACode};

/// Nanoseconds of a second.
pub(crate) const SECOND_NS: u32 = 1_000_000_000;
/// Seconds of a day.
pub(crate) const DAY_S: u32 = 86_400;

/// What was received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bits<'a> {
    /// A Mode S frame, its bits as received.
    ModeS(&'a Frame),
    /// A Mode A or Mode C reply: nobody can tell which.
    ModeAc {
        code: ModeACode,
        /// The special position identification pulse.
        spi: bool,
    },
}

/// When a frame arrived.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameTimes {
    /// Ticks of 120 MHz since the start of capture; they never restart.
    pub arrival: u64,
    /// Nanoseconds since the last PPS, calibrated, below 1 000 000 000; `None` without a disciplined PPS.
    pub since_pps_ns: Option<u32>,
    /// UTC second of the day that began with that PPS, below 86 400; `None` until the time of day is known.
    pub utc_second: Option<u32>,
}

impl FrameTimes {
    /// An arrival of which only the tick is known.
    pub const fn at(arrival: u64) -> FrameTimes {
        FrameTimes {
            arrival,
            since_pps_ns: None,
            utc_second: None,
        }
    }

    /// TS1s: nanoseconds since the last PPS.
    pub fn ts1s_ns(&self) -> Option<u32> {
        self.since_pps_ns
    }

    /// TS24h: nanoseconds since UTC midnight.
    pub fn ts24h_ns(&self) -> Option<u64> {
        let (second, ns) = (self.utc_second?, self.since_pps_ns?);
        Some(u64::from(second) * u64::from(SECOND_NS) + u64::from(ns))
    }
}

/// A frame and its reception.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameReport<'a> {
    /// The bits.
    pub bits: Bits<'a>,
    /// SIGS: level, hundredths of a dBm.
    pub level_cdbm: Option<i16>,
    /// SIGQ: level over the tracked noise floor, hundredths of a dB.
    pub quality_cdb: Option<i16>,
    /// When.
    pub times: FrameTimes,
}

impl<'a> FrameReport<'a> {
    /// A Mode S frame of which only the arrival (ticks of 120 MHz) is known.
    pub const fn of_frame(frame: &'a Frame, arrival: u64) -> FrameReport<'a> {
        FrameReport {
            bits: Bits::ModeS(frame),
            level_cdbm: None,
            quality_cdb: None,
            times: FrameTimes::at(arrival),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ts24h_needs_both_the_pps_and_the_time_of_day() {
        let mut times = FrameTimes::at(1);
        assert_eq!((times.ts1s_ns(), times.ts24h_ns()), (None, None));
        times.utc_second = Some(47_655);
        assert_eq!(times.ts24h_ns(), None);
        times.since_pps_ns = Some(123_456_789);
        assert_eq!(times.ts24h_ns(), Some(0x2B57_92B4_9315));
        times.utc_second = None;
        assert_eq!(times.ts1s_ns(), Some(0x75B_CD15));
        assert_eq!(times.ts24h_ns(), None);
    }
}
