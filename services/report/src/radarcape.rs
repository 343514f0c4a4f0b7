//! Beast's status message in GPS mode (type 4), as the Radarcape sends it: by it readers know what the stamps of frames mean.
//!
//! ```text
//!   1A '4'  stamp ×6  level FF  settings  PPS difference  GPS status  0 ×11      every 1A behind the type doubled
//!   settings    bit 0 Beast  1 only frames with good parity  4 GPS stamps  6 no FEC  7 Mode A/C on
//!   GPS status  bit 7 the second is UTC's own  5 stamps do not follow GPS  4 synchronised  3 UTC offset known  2 satellites  1 tracking  0 antenna
//! ```
//! Source: how the reader of mlat-client takes it.

use crate::Full;
use crate::beast::{LEVEL_UNKNOWN, Stamp, message, seconds_and_ns};
use crate::frame_report::FrameTimes;

/// Settings: Beast format, GPS stamps.
mod setting {
    pub const BEAST: u8 = 0x01;
    pub const FILTERED: u8 = 0x02;
    pub const GPS: u8 = 0x10;
    pub const NO_FEC: u8 = 0x40;
    pub const MODE_AC: u8 = 0x80;
}

/// GPS status: the second is right, and all is well or not.
mod gps {
    pub const UTC_SECOND: u8 = 0x80;
    pub const NOT_GPS_TIME: u8 = 0x20;
    pub const WELL: u8 = 0x1F;
}

/// What the stream carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stream {
    /// Stamps of frames.
    pub stamp: Stamp,
    /// Only frames with good parity are sent.
    pub filtered: bool,
    /// Mode A/C replies are sent.
    pub mode_ac: bool,
}

/// The status message at this time; `times.arrival` counts where the stream does.
pub fn status(stream: &Stream, times: &FrameTimes, out: &mut [u8]) -> Result<usize, Full> {
    let utc = times.utc_second.zip(times.since_pps_ns);
    let stamp = match stream.stamp {
        Stamp::Gps => utc.map_or(0, |(second, ns)| seconds_and_ns(second, ns)),
        Stamp::Count12Mhz => times.arrival / crate::beast::TICKS_PER_COUNT,
    };
    let settings = [
        (true, setting::BEAST | setting::NO_FEC),
        (stream.filtered, setting::FILTERED),
        (stream.stamp == Stamp::Gps, setting::GPS),
        (stream.mode_ac, setting::MODE_AC),
    ];
    let mut data = [0; 14];
    let on = settings.iter().filter(|(is_on, _)| *is_on);
    data[0] = on.fold(0, |all, (_, bit)| all | bit);
    data[2] = gps::UTC_SECOND
        | match utc {
            Some(_) => gps::WELL,
            None => gps::NOT_GPS_TIME,
        };
    message(b'4', stamp, LEVEL_UNKNOWN, &data, out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beast::MAX_MESSAGE;

    #[test]
    fn gps_mode_with_and_without_time() {
        let mut out = [0; MAX_MESSAGE];
        let stream = Stream {
            stamp: Stamp::Gps,
            filtered: true,
            mode_ac: false,
        };
        let mut times = FrameTimes::at(120);
        let length = status(&stream, &times, &mut out).unwrap();
        assert_eq!(length, 23);
        assert_eq!(out[..2], [0x1A, b'4']);
        assert_eq!(out[2..9], [0, 0, 0, 0, 0, 0, 0xFF]);
        assert_eq!(out[9..12], [0x53, 0, 0xA0]);
        times.utc_second = Some(1);
        times.since_pps_ns = Some(5);
        let length = status(&stream, &times, &mut out).unwrap();
        assert_eq!(out[2..8], (1u64 << 30 | 5).to_be_bytes()[2..]);
        assert_eq!(out[9..12], [0x53, 0, 0x9F]);
        for short in 0..length {
            assert_eq!(status(&stream, &times, &mut out[..short]), Err(Full));
        }
    }

    #[test]
    fn counting_mode_says_so() {
        let mut out = [0; MAX_MESSAGE];
        let stream = Stream {
            mode_ac: true,
            ..Stream::default()
        };
        status(&stream, &FrameTimes::at(120), &mut out).unwrap();
        assert_eq!(out[2..8], [0, 0, 0, 0, 0, 12]);
        assert_eq!(out[9], 0xC1);
    }
}
