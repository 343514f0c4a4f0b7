//! Published frames with known contents, and any bytes at all.

use super::*;
use crate::address::Icao;
use crate::angle::CentiDegrees;
use crate::cpr::{Cpr, Position, global, local};
use crate::frame::tests::frame;
use crate::me::airborne_position::{AltitudeSource, PositionAltitude};
use crate::me::velocity::{Airspeed, HorizontalVelocity, VerticalRate};
use proptest::prelude::*;

fn me(hex: &str) -> Me {
    let message = Message::decode(&frame(hex));
    assert!(matches!(message.parity, Parity::Exact(_)), "{hex}");
    match message.body {
        Body::ExtendedSquitter { me, .. } => me,
        other => panic!("{hex}: {other:?}"),
    }
}

fn cpr(hex: &str) -> Cpr {
    match me(hex) {
        Me::AirbornePosition(position) => position.cpr.unwrap(),
        Me::SurfacePosition(position) => position.cpr.unwrap(),
        other => panic!("{hex}: {other:?}"),
    }
}

/// Degrees to five decimals.
fn rounded(place: Option<Position>) -> (f64, f64) {
    let round = |angle: i32| (f64::from(angle) / 100.0).round() / 1e5;
    let place = place.unwrap();
    (round(place.latitude), round(place.longitude))
}

#[test]
fn airborne_position_at_36_000_ft() {
    let Me::AirbornePosition(position) = me("8D4CA7E858B9838206BA422BBD7B") else {
        panic!()
    };
    assert_eq!(
        position.altitude,
        Some(PositionAltitude {
            source: AltitudeSource::Barometric,
            altitude: AltitudeFt(36_000)
        })
    );
}

#[test]
fn airborne_pairs_of_two_hemispheres() {
    let first = cpr("8da6147f5859f18cdf4d244ac6fa");
    let second = cpr("8da6147f585b05533e2ba73e43cb");
    let (latitude, longitude) = rounded(global(first, second, None));
    assert_eq!((latitude, longitude), (20.32652, -156.53285));

    let first = cpr("8D48922358C387D91DF354DCCCB8");
    let second = cpr("8D48922358C38066020D8401D571");
    let (latitude, longitude) = rounded(global(first, second, None));
    assert!((latitude - 48.5977).abs() < 6e-5, "{latitude}");
    assert!((longitude - 18.7052).abs() < 6e-5, "{longitude}");
}

#[test]
fn surface_pair_near_a_reference() {
    let reference = Position {
        latitude: 519_900_000,
        longitude: 43_750_000,
    };
    let first = cpr("8C4841753AAB238733C8CD4020B1");
    let second = cpr("8C4841753A8A35323FAEBDAC702D");
    let pair = global(first, second, Some(reference)).unwrap();
    // 52.320607, 4.734735 to a unit of the last digit.
    assert!((pair.latitude - 523_206_070).abs() <= 10, "{pair:?}");
    assert!((pair.longitude - 47_347_350).abs() <= 10, "{pair:?}");
    assert_eq!(local(second, reference), Some(pair));
}

#[test]
fn altitude_reply() {
    let message = Message::decode(&frame("200006A2DE8B1C"));
    assert_eq!(message.parity, Parity::Address(Icao(0x7C1B28)));
    assert_eq!(
        message.body,
        Body::AltitudeReply {
            flight_status: FlightStatus(0),
            control: ReplyControl::default(),
            altitude: Some(AltitudeFt(10_000)),
            metres: None,
            mb: None,
        }
    );
}

#[test]
fn identity_reply() {
    let message = Message::decode(&frame("29001B3AF47E76"));
    assert_eq!(message.parity, Parity::Address(Icao(0x7C1474)));
    assert_eq!(
        message.body,
        Body::IdentityReply {
            flight_status: FlightStatus(1),
            control: ReplyControl::default(),
            squawk: ModeACode(0o3751),
            mb: None,
        }
    );
}

#[test]
fn velocity_over_the_ground() {
    let Me::Velocity(velocity) = me("8D485020994409940838175B284F") else {
        panic!()
    };
    assert_eq!(
        velocity.horizontal,
        Some(HorizontalVelocity::Ground {
            speed_kt: 159,
            track: Some(CentiDegrees(18_288))
        })
    );
    assert_eq!(
        velocity.vertical_rate,
        Some(VerticalRate {
            feet_per_minute: -832,
            is_barometric: false
        })
    );
    assert_eq!(velocity.gnss_minus_baro_ft, Some(550));
}

#[test]
fn velocity_through_the_air() {
    let Me::Velocity(velocity) = me("8DA05F219B06B6AF189400CBC33F") else {
        panic!()
    };
    assert_eq!(
        velocity.horizontal,
        Some(HorizontalVelocity::Air {
            heading: Some(CentiDegrees(24_398)),
            airspeed: Some(Airspeed {
                knots: 375,
                is_true: true
            })
        })
    );
    assert_eq!(
        velocity.vertical_rate,
        Some(VerticalRate {
            feet_per_minute: -2304,
            is_barometric: true
        })
    );
    assert_eq!(velocity.gnss_minus_baro_ft, None);
}

#[test]
fn all_call_reply() {
    let message = Message::decode(&frame("5D4B18FFFC710B"));
    assert_eq!(
        message.body,
        Body::AllCallReply {
            capability: Capability(5)
        }
    );
    assert_eq!(message.address(), Some(Address::Icao(Icao(0x4B18FF))));
}

#[test]
fn a_broken_frame_has_no_fields() {
    let message = Message::decode(&frame("8D4CA7E858B9838206BA422BBD7A"));
    assert_eq!(message.parity, Parity::Broken);
    assert_eq!(message.body, Body::NotDecoded);
    assert_eq!(message.address(), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, failure_persistence: None, ..ProptestConfig::default() })]

    /// With a parity made right, so that every ME type and field value comes by.
    #[test]
    fn any_bytes_decode_without_panic(mut bytes in prop::array::uniform14(any::<u8>()), right_parity in any::<bool>()) {
        let length = if Df::of_first_byte(bytes[0]).is_long() { 14 } else { 7 };
        if right_parity {
            let parity = crate::crc24::remainder(&bytes[..length - 3]).to_be_bytes();
            bytes[length - 3..length].copy_from_slice(&parity[1..]);
        }
        let frame = Frame::from_bytes(&bytes[..length]);
        prop_assert!(frame.is_ok());
        if let Ok(frame) = frame {
            let message = Message::decode(&frame);
            prop_assert_eq!(frame.bytes(), &bytes[..length]);
            if let Body::ExtendedSquitter { me: Me::Velocity(velocity), .. } = message.body
                && let Some(HorizontalVelocity::Ground { track: Some(track), .. }) = velocity.horizontal
            {
                prop_assert!(track.0 < 36_000);
            }
        }
    }

    #[test]
    fn any_slice_is_a_frame_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..20)) {
        if let Ok(frame) = Frame::from_bytes(&bytes) {
            prop_assert_eq!(frame.bytes(), &bytes[..]);
        }
    }
}

#[test]
fn surface_movement_and_track() {
    let Me::SurfacePosition(position) = me("8C4841753AAB238733C8CD4020B1") else {
        panic!()
    };
    // 18 kt, 140.625°.
    assert_eq!(position.ground_speed_eighths, Some(18 * 8));
    assert_eq!(position.track, Some(CentiDegrees(14_063)));
}

#[test]
fn air_air_surveillance_tells_ground_and_altitude() {
    // VS is bit 6; AC 0x06A2 is 10 000 ft.
    for (first, on_ground) in [(0x00, false), (0x04, true)] {
        let frame = Frame::from_bytes(&[first, 0, 0x06, 0xA2, 1, 2, 3]).unwrap();
        assert_eq!(
            Message::decode(&frame).body,
            Body::AirAir {
                on_ground,
                acas: AcasReply::default(),
                altitude: Some(AltitudeFt(10_000)),
                metres: None,
                mv: None,
            }
        );
    }
}

/// A frame of these leading bytes, zeros behind and right parity for `address` (0 where the parity is plain).
fn frame_of(head: &[u8], length: usize, address: u32) -> Message {
    let mut bytes = std::vec![0; length];
    bytes[..head.len()].copy_from_slice(head);
    let parity = (crate::crc24::remainder(&bytes[..length - 3]) ^ address).to_be_bytes();
    bytes[length - 3..].copy_from_slice(&parity[1..]);
    Message::decode(&Frame::from_bytes(&bytes).unwrap())
}

#[test]
fn reply_fields_stand_in_their_bits() {
    // FS 5, DR 0b10110, UM 0b101101.
    let message = frame_of(&[4 << 3 | 5, 0b1011_0101, 0b1010_0000], 7, 1);
    let Body::AltitudeReply {
        flight_status,
        control,
        ..
    } = message.body
    else {
        panic!()
    };
    assert_eq!(flight_status, FlightStatus(5));
    assert_eq!(control.downlink_request, 0b10110);
    assert_eq!(control.utility_message, 0b101101);
    // CC, SL 5, RI 0b1011.
    for (df, length, cross_link) in [(0, 7, true), (16, 14, false)] {
        let head = [df << 3 | 0b010, 0b1010_0101, 0b1000_0000];
        let Body::AirAir { acas, mv, .. } = frame_of(&head, length, 1).body else {
            panic!()
        };
        assert_eq!(
            acas,
            AcasReply {
                cross_link,
                sensitivity_level: 5,
                reply_information: 0b1011,
            }
        );
        assert_eq!(mv.is_some(), length == 14);
    }
}

#[test]
fn df16_with_vds_30_coordinates_an_advisory() {
    let head = |vds| [0x80, 0, 0, 0, vds, 0x80, 0, 0x20, 0, 0, 0];
    let advisory = frame_of(&head(0x30), 14, 1).coordination().unwrap();
    assert!(advisory.bit(9) && advisory.terminated && !advisory.is_active());
    assert_eq!(frame_of(&head(0x31), 14, 1).coordination(), None);
    assert_eq!(frame_of(&[0; 4], 7, 1).coordination(), None);
}

#[test]
fn df18_by_its_control_field() {
    let me = 4 << 3 | 1;
    for (cf, origin) in [
        (0, Some(Origin::Device)),
        (1, Some(Origin::AnonymousDevice)),
        (2, Some(Origin::Tisb)),
        (3, None),
        (4, None),
        (5, Some(Origin::AnonymousTisb)),
        (6, Some(Origin::Rebroadcast)),
        (7, None),
    ] {
        let message = frame_of(&[18 << 3 | cf, 0, 0, 1, me], 14, 0);
        match message.body {
            Body::ExtendedSquitter { origin: found, me } => {
                assert_eq!(Some(found), origin, "CF {cf}");
                assert_eq!(found.control_field(), Some(cf));
                assert_eq!(me.type_code(), 4);
            }
            Body::CoarsePosition(position) => {
                assert_eq!((cf, position.service_volume), (3, 0));
            }
            Body::Management { content } => {
                assert_eq!((cf, content.bits(1, 8)), (4, u32::from(me)));
            }
            Body::NotDecoded => assert_eq!(cf, 7),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn military_squitters_by_their_application() {
    let civil = frame_of(&[19 << 3, 0, 0, 1, 11 << 3], 14, 0);
    assert!(matches!(
        civil.body,
        Body::ExtendedSquitter {
            origin: Origin::Military,
            me: Me::AirbornePosition(_)
        }
    ));
    for application in 1..8 {
        let message = frame_of(&[19 << 3 | application], 14, 0x1234);
        assert_eq!(message.parity, Parity::Unjudged);
        assert_eq!(message.body, Body::Military { application });
    }
}

#[test]
fn a_message_stays_small() {
    assert!(size_of::<Message>() <= 64, "{}", size_of::<Message>());
}
