//! Places in space: WGS-84, earth-centred and fixed to it, metres.
//!
//! Source: NIMA TR8350.2 (the ellipsoid's two numbers); ITU-R P.453 (mean refractivity of the air and how it falls with height).

use crate::front_end::decibel::sin_cos;

/// Semi-major axis, metres, and flattening.
const A: f64 = 6_378_137.0;
const F: f64 = 1.0 / 298.257_223_563;
/// Speed of light in a vacuum, metres a second.
pub const LIGHT_M_S: f64 = 299_792_458.0;
/// What air's refractive index exceeds 1 by at sea level, and the height over which that falls to 1/e, metres.
const REFRACTIVITY: f64 = 315e-6;
const REFRACTIVITY_HEIGHT_M: f64 = 7_350.0;

/// X, Y, Z.
pub type Place = [f64; 3];

/// Degrees north and east and metres over the ellipsoid.
pub fn from_degrees(latitude: f64, longitude: f64, height_m: f64) -> Place {
    let (sin_lat, cos_lat) = sin_cos(latitude.to_radians());
    let (sin_lon, cos_lon) = sin_cos(longitude.to_radians());
    let e2 = F * (2.0 - F);
    let n = A / (1.0 - e2 * sin_lat * sin_lat).sqrt();
    [
        (n + height_m) * cos_lat * cos_lon,
        (n + height_m) * cos_lat * sin_lon,
        (n * (1.0 - e2) + height_m) * sin_lat,
    ]
}

/// Metres between two places.
pub fn distance_m(a: Place, b: Place) -> f64 {
    let squares = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// The way that light in a vacuum goes in the time it takes through the air for this one, metres: 100 km up to an aircraft are 20 to 30 m longer. From the ground to a
/// height, along a straight line.
pub fn through_air_m(distance_m: f64, height_m: f64) -> f64 {
    let heights = height_m.max(1.0) / REFRACTIVITY_HEIGHT_M;
    let mean = REFRACTIVITY * (1.0 - (-heights).exp()) / heights;
    distance_m * (1.0 + mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn air_is_slower_than_nothing_near_the_ground_above_all() {
        assert!((through_air_m(100_000.0, 0.0) - 100_031.5).abs() < 0.1);
        // The mean of an exponential from 0 to its height: 0.632.
        let high = through_air_m(100_000.0, 7_350.0);
        assert!((high - 100_019.91).abs() < 0.1, "{high}");
    }

    #[test]
    fn the_ellipsoid_is_as_wide_as_it_is() {
        assert!((from_degrees(0.0, 0.0, 0.0)[0] - A).abs() < 0.01);
        assert!((from_degrees(90.0, 0.0, 0.0)[2] - 6_356_752.314).abs() < 0.01);
        // A minute of latitude is a nautical mile, nearly.
        let mile = distance_m(
            from_degrees(45.0, 9.0, 0.0),
            from_degrees(45.0 + 1.0 / 60.0, 9.0, 0.0),
        );
        assert!((mile - 1_852.0).abs() < 2.0, "{mile}");
        let up = distance_m(
            from_degrees(50.0, 9.0, 0.0),
            from_degrees(50.0, 9.0, 1_000.0),
        );
        assert!((up - 1_000.0).abs() < 1e-6);
    }
}
