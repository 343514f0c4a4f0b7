//! The JSON section `gnss`: where the receiver is.
//!
//! | field | unit | left out |
//! |---|---|---|
//! | fix | 1 now, 0 not | never |
//! | lat, lon | degrees, up to seven decimals | before the first fix |
//! | altWgs84, altMsl | m | before the first fix |
//! | track, hVelo | degrees, kt | unknown |
//! | vVelo | m/s, up positive | unknown |
//! | gndSpeed | kt to the east, kt to the north; from track and hVelo | either unknown |
//! | acc: lat, lon, alt | m, standard deviation | unknown |
//! | nacp | by `acc` | unknown |
//!
//! `nacv` and `nic` are never known of the receiver's own GNSS and left out.

use crate::Full;
use crate::gnss::Gnss;
use crate::json::message;
use crate::json_object::Object;
use crate::moment::Moment;
use crate::sine::{ONE, cosine, sine};

/// Faster than anything that carries a receiver, hundredths of a knot; keeps products within 32 bits.
const MOST_CENTIKNOTS: u32 = 65_535;

/// The `gnss` section.
pub fn gnss(source: &str, gnss: &Gnss, moment: &Moment, out: &mut [u8]) -> Result<usize, Full> {
    message(source, moment, out, |object| {
        let mut section = object.object("gnss")?;
        section.number("fix", gnss.has_fix)?;
        section.scaled("lat", gnss.position.map(|p| p.latitude), 7)?;
        section.scaled("lon", gnss.position.map(|p| p.longitude), 7)?;
        section.scaled("altWgs84", gnss.ellipsoid_cm, 2)?;
        section.scaled("altMsl", gnss.sea_level_cm, 2)?;
        section.scaled("track", gnss.track.map(|t| i32::from(t.0)), 2)?;
        let speed = gnss.speed_centiknots;
        let speed = speed.map(|speed| speed.min(MOST_CENTIKNOTS) as i32);
        section.scaled("hVelo", speed, 2)?;
        section.scaled("vVelo", gnss.climb_cm_s, 2)?;
        if let (Some(track), Some(speed)) = (gnss.track, speed) {
            let text = section.key("gndSpeed")?;
            text.byte(b'[')?;
            text.scaled(share(speed, sine(track.0)), 2)?;
            text.byte(b',')?;
            text.scaled(share(speed, cosine(track.0)), 2)?;
            text.byte(b']')?;
        }
        accuracy(&mut section, gnss)?;
        section.maybe("nacp", gnss.nac_p().filter(|&nac_p| nac_p != 0))?;
        section.close()
    })
}

/// A part of the speed, rounded.
fn share(speed: i32, part: i32) -> i32 {
    // At most 65 535 × 32 768.
    (speed * part + ONE / 2).div_euclid(ONE)
}

fn accuracy(section: &mut Object<'_, '_>, gnss: &Gnss) -> Result<(), Full> {
    let errors = [
        ("lat", gnss.latitude_error_cm),
        ("lon", gnss.longitude_error_cm),
        ("alt", gnss.height_error_cm),
    ];
    if errors.iter().all(|(_, error)| error.is_none()) {
        return Ok(());
    }
    let mut accuracy = section.object("acc")?;
    for (name, error) in errors {
        accuracy.scaled(name, error.map(|cm| cm.min(i32::MAX as u32) as i32), 2)?;
    }
    accuracy.close()
}
