//! What the sentences add up to: the last known place and motion, and how good the fix is now.
//!
//! The last known values stay when the fix is lost, with the second in which they were heard; [`Fix::has_fix`] says whether they are of today. A receiver that falls
//! silent has no fix after [`SILENT_AFTER_MS`].

use crate::sentence::{Quality, Sentence};

/// Without a sentence that tells of a fix for so long there is none, milliseconds: three seconds, so that one garbled second costs nothing.
pub const SILENT_AFTER_MS: u64 = 3_000;

/// A position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// 1e-7 degrees, north and east positive.
    pub latitude: i32,
    pub longitude: i32,
}

/// What the fix has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dimensions {
    #[default]
    None,
    /// Without height; its time is worse.
    Two,
    Three,
}

/// The last known values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fix {
    pub place: Option<Place>,
    /// Above mean sea level, centimetres; above the ellipsoid with the geoid added.
    pub height_cm: Option<i32>,
    pub geoid_cm: Option<i32>,
    /// Over ground.
    pub speed_millikt: Option<u32>,
    pub track_cdeg: Option<u16>,
    pub satellites: Option<u8>,
    pub pdop_c: Option<u16>,
    /// One-sigma errors, centimetres: latitude, longitude, height.
    pub sigma_cm: [Option<u32>; 3],
    dimensions: Dimensions,
    valid: bool,
    /// When a sentence told of the fix or its lack, milliseconds of uptime.
    told_at_ms: Option<u64>,
}

impl Fix {
    /// Nothing known.
    pub const fn new() -> Self {
        Self {
            place: None,
            height_cm: None,
            geoid_cm: None,
            speed_millikt: None,
            track_cdeg: None,
            satellites: None,
            pdop_c: None,
            sigma_cm: [None; 3],
            dimensions: Dimensions::None,
            valid: false,
            told_at_ms: None,
        }
    }

    /// Takes a sentence heard at this uptime.
    pub fn hear(&mut self, sentence: &Sentence, now_ms: u64) {
        match sentence {
            Sentence::Rmc(rmc) => {
                self.tell(rmc.valid, now_ms);
                if rmc.valid {
                    self.at(rmc.position);
                    // Standing still has no track: the one before stays out of it.
                    self.speed_millikt = rmc.speed_millikt;
                    self.track_cdeg = rmc.track_cdeg;
                }
            }
            Sentence::Gga(gga) => {
                self.tell(gga.quality == Quality::Satellites, now_ms);
                self.satellites = gga.satellites;
                if self.valid {
                    self.at(gga.position);
                    self.height_cm = gga.height_cm.or(self.height_cm);
                    self.geoid_cm = gga.geoid_cm.or(self.geoid_cm);
                }
            }
            Sentence::Gsa(gsa) => {
                self.dimensions = match gsa.dimensions {
                    Some(3) => Dimensions::Three,
                    Some(2) => Dimensions::Two,
                    _ => Dimensions::None,
                };
                self.pdop_c = gsa.pdop_c;
            }
            Sentence::Gst(gst) => {
                self.sigma_cm = [gst.latitude_cm, gst.longitude_cm, gst.height_cm];
            }
            Sentence::Zda(_) | Sentence::Other => {}
        }
    }

    fn tell(&mut self, valid: bool, now_ms: u64) {
        self.valid = valid;
        self.told_at_ms = Some(now_ms);
    }

    fn at(&mut self, position: Option<(i32, i32)>) {
        if let Some((latitude, longitude)) = position {
            self.place = Some(Place {
                latitude,
                longitude,
            });
        }
    }

    /// `Some` while the receiver tells whether it has a fix; `None` while it is silent.
    pub fn told(&self, now_ms: u64) -> Option<bool> {
        let told = self
            .told_at_ms
            .is_some_and(|at| now_ms.saturating_sub(at) <= SILENT_AFTER_MS);
        told.then_some(self.valid)
    }

    /// The receiver has a fix now.
    pub fn has_fix(&self, now_ms: u64) -> bool {
        self.told(now_ms) == Some(true)
    }

    /// Its dimensions now. A receiver without GSA that has a fix is taken at its word.
    pub fn dimensions(&self, now_ms: u64) -> Dimensions {
        match (self.has_fix(now_ms), self.dimensions) {
            (false, _) => Dimensions::None,
            (true, Dimensions::Two) => Dimensions::Two,
            (true, _) => Dimensions::Three,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hear(fix: &mut Fix, text: &str, now_ms: u64) {
        fix.hear(&Sentence::parse(text.as_bytes()), now_ms);
    }

    const VALID: &str = "$GNRMC,030405.00,A,4721.39660,N,00831.14203,E,1.5,90.0,020126,,,A*00";
    const LOST: &str = "$GNRMC,030406.00,V,,,,,,,020126,,,N*00";

    #[test]
    fn the_last_known_place_stays_when_the_fix_is_lost() {
        let mut fix = Fix::new();
        assert_eq!(fix.told(0), None);
        hear(&mut fix, VALID, 1_000);
        assert!(fix.has_fix(1_000));
        let place = fix.place;
        assert!(place.is_some());
        hear(&mut fix, LOST, 2_000);
        assert_eq!((fix.told(2_000), fix.place), (Some(false), place));
    }

    #[test]
    fn a_receiver_that_falls_silent_has_no_fix() {
        let mut fix = Fix::new();
        hear(&mut fix, VALID, 1_000);
        assert!(fix.has_fix(1_000 + SILENT_AFTER_MS));
        assert_eq!(fix.told(1_001 + SILENT_AFTER_MS), None);
        assert_eq!(fix.dimensions(1_001 + SILENT_AFTER_MS), Dimensions::None);
    }

    #[test]
    fn dimensions_are_gsas_while_there_is_a_fix() {
        let mut fix = Fix::new();
        hear(&mut fix, VALID, 0);
        assert_eq!(fix.dimensions(0), Dimensions::Three);
        hear(&mut fix, "$GNGSA,A,2,,,,,,,,,,,,,5.0,3.0,1.0*00", 0);
        assert_eq!(fix.dimensions(0), Dimensions::Two);
        assert_eq!(fix.pdop_c, Some(500));
    }
}
