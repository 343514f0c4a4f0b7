//! How strongly an aircraft is heard: the mean of a second's frames.
//!
//! Means are of the figures in dB, as the reports' SIGS and SIGQ print them. They stay while no frame comes.

/// How a frame was heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// When, milliseconds of the receiver's clock.
    pub at_ms: u64,
    /// Level, hundredths of a dBm, where measured.
    pub level_cdbm: Option<i16>,
    /// Level over the noise floor, hundredths of a dB, where measured (only beside a level).
    pub quality_cdb: Option<i16>,
    /// The demodulator has repaired bits of it: such a frame is trusted less than its parity says.
    pub is_repaired: bool,
    /// Nanoseconds since the last PPS, below 1 000 000 000, where that is known.
    pub since_pps_ns: Option<u32>,
}

impl Heard {
    /// A frame heard at this time, of which nothing else is known.
    pub const fn at(at_ms: u64) -> Heard {
        Heard {
            at_ms,
            level_cdbm: None,
            quality_cdb: None,
            is_repaired: false,
            since_pps_ns: None,
        }
    }
}

/// Level and quality of an aircraft's frames: means in the making, and the last ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Signal {
    level_sum: i32,
    quality_sum: i32,
    /// Frames in both sums.
    count: u16,
    /// 0 stands for none: no frame is as strong as 0 dBm or as weak as the noise.
    level: i16,
    quality: i16,
}

impl Signal {
    pub(crate) const NONE: Signal = Signal {
        level_sum: 0,
        quality_sum: 0,
        count: 0,
        level: 0,
        quality: 0,
    };

    pub(crate) fn hear(&mut self, heard: &Heard) {
        if let Some(level) = heard.level_cdbm
            && self.count < u16::MAX
        {
            self.level_sum += i32::from(level);
            self.quality_sum += i32::from(heard.quality_cdb.unwrap_or(0));
            self.count += 1;
        }
    }

    pub(crate) fn second_ends(&mut self) {
        if self.count != 0 {
            // Means of 16-bit values fit 16 bits.
            self.level = (self.level_sum / i32::from(self.count)) as i16;
            self.quality = (self.quality_sum / i32::from(self.count)) as i16;
            (self.level_sum, self.quality_sum, self.count) = (0, 0, 0);
        }
    }

    pub(crate) fn level_cdbm(&self) -> Option<i16> {
        Some(self.level).filter(|&level| level != 0)
    }

    pub(crate) fn quality_cdb(&self) -> Option<i16> {
        Some(self.quality).filter(|&quality| quality != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_tells_the_mean_and_silence_keeps_it() {
        let mut signal = Signal::NONE;
        assert_eq!(signal.level_cdbm(), None);
        for level in [-7_000, -6_000, -6_500] {
            signal.hear(&Heard {
                level_cdbm: Some(level),
                quality_cdb: Some(1_000),
                ..Heard::at(0)
            });
        }
        signal.hear(&Heard::at(0));
        signal.second_ends();
        assert_eq!(signal.level_cdbm(), Some(-6_500));
        assert_eq!(signal.quality_cdb(), Some(1_000));
        signal.second_ends();
        assert_eq!(signal.level_cdbm(), Some(-6_500));
    }

    #[test]
    fn extremes_of_every_frame_of_a_full_second_do_not_overflow() {
        for extreme in [i16::MIN, i16::MAX] {
            let mut signal = Signal::NONE;
            for _ in 0..70_000 {
                signal.hear(&Heard {
                    level_cdbm: Some(extreme),
                    ..Heard::at(0)
                });
            }
            signal.second_ends();
            assert_eq!(signal.level_cdbm(), Some(extreme));
        }
    }
}
