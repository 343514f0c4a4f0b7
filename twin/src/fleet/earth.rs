//! Places in space: WGS-84, earth-centred and fixed to it, metres.
//!
//! Source: NIMA TR8350.2 (the ellipsoid's two numbers).

use crate::front_end::decibel::sin_cos;

/// Semi-major axis, metres, and flattening.
const A: f64 = 6_378_137.0;
const F: f64 = 1.0 / 298.257_223_563;
/// Speed of light, metres a second.
pub const LIGHT_M_S: f64 = 299_792_458.0;

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

#[cfg(test)]
mod tests {
    use super::*;

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
