//! Any bytes give possible values, and the table is no table of everything: a value past each end is refused.

use super::*;
use crate::frame::{Df, Frame};
use crate::surveillance::Capability;
use proptest::prelude::*;

/// A frame of these bytes, cut to the length of its DF.
fn decode(mut bytes: [u8; 14], right_parity: bool) -> Message {
    let length = if Df::of_first_byte(bytes[0]).is_long() {
        14
    } else {
        7
    };
    if right_parity {
        let parity = crate::crc24::remainder(&bytes[..length - 3]).to_be_bytes();
        bytes[length - 3..length].copy_from_slice(&parity[1..]);
    }
    Message::decode(&Frame::from_bytes(&bytes[..length]).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_hold_possible_values(bytes in prop::array::uniform14(any::<u8>()), right_parity in any::<bool>()) {
        prop_assert_eq!(possible(&decode(bytes, right_parity)), Ok(()));
    }

    /// Every first byte of a squitter, so that each ME type comes by often.
    #[test]
    fn any_squitter_holds_possible_values(
        mut bytes in prop::array::uniform14(any::<u8>()),
        df in 17u8..20,
        type_code in 0u8..32,
        subtype in 0u8..8,
        rest in any::<bool>(),
    ) {
        bytes[0] = df << 3 | if rest { bytes[0] & 7 } else { 0 };
        bytes[4] = type_code << 3 | subtype;
        prop_assert_eq!(possible(&decode(bytes, true)), Ok(()));
    }
}

#[test]
fn the_ends_of_every_field_are_possible() {
    // All ones and all zeros in ME: the ends of most ranges.
    for fill in [0x00, 0xFF] {
        for first in 0..=255u8 {
            for me in 0..=255u8 {
                let mut bytes = [fill; 14];
                bytes[0] = first;
                bytes[4] = me;
                assert_eq!(
                    possible(&decode(bytes, true)),
                    Ok(()),
                    "{first:02X} {me:02X}"
                );
            }
        }
    }
}

#[test]
fn a_value_past_its_range_is_named() {
    let squitter = |me| Message {
        df: Df::EXTENDED_SQUITTER,
        parity: Parity::Exact(Address::Icao(Icao(1))),
        body: Body::ExtendedSquitter {
            origin: crate::message::Origin::Transponder(Capability(5)),
            me,
        },
    };
    let surface = |speed, degrees| {
        squitter(Me::SurfacePosition(crate::SurfacePosition {
            type_code: 7,
            movement: 1,
            ground_speed_eighths: Some(speed),
            track: Some(CentiDegrees(degrees)),
            utc_synchronised: false,
            cpr: None,
        }))
    };
    assert_eq!(possible(&surface(1_400, 35_999)), Ok(()));
    let (field, value) = ("surface speed", 1_401);
    assert_eq!(
        possible(&surface(1_401, 0)),
        Err(Impossible { field, value })
    );
    let (field, value) = ("angle", 36_000);
    assert_eq!(
        possible(&surface(0, 36_000)),
        Err(Impossible { field, value })
    );
    let altitude = Message {
        body: Body::AltitudeReply {
            flight_status: crate::FlightStatus(0),
            control: crate::ReplyControl::default(),
            altitude: Some(AltitudeFt(-1_300)),
            metres: None,
            mb: None,
        },
        ..surface(0, 0)
    };
    let (field, value) = ("altitude", -1_300);
    assert_eq!(possible(&altitude), Err(Impossible { field, value }));
}
