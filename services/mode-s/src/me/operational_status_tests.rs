//! Operational status: frames of two recorded logs, and each field by version.

use super::*;
use crate::frame::tests::frame;

fn decode(hex: &str) -> OperationalStatus {
    OperationalStatus::decode(frame(hex).me())
}

/// An ME field of this subtype and version with these bits set.
fn with_bits(subtype: u8, version: u8, bits: &[usize]) -> OperationalStatus {
    let mut me = [31 << 3 | subtype, 0, 0, 0, 0, version << 5, 0];
    for bit in bits {
        me[(bit - 1) / 8] |= 0x80 >> ((bit - 1) % 8);
    }
    OperationalStatus::decode(MeBits::new(me))
}

#[test]
fn an_airliner_in_the_air() {
    assert_eq!(
        decode("8D486257F8230002004BB89498E3"),
        OperationalStatus {
            on_surface: false,
            version: 2,
            capability_class: 0x2300,
            operational_mode: 0x0200,
            nic_a: Some(false),
            nic_c: None,
            nac_p: Some(11),
            nac_v: None,
            gva: Some(2),
            sil: Some(3),
            sil_per_sample: Some(false),
            sda: Some(2),
            nic_baro: Some(true),
            surface_heading: None,
            magnetic_heading: Some(false),
            tcas_operational: Some(true),
            tcas_ra: Some(false),
            ident: Some(false),
            atc_services: None,
            traffic_display: None,
            air_velocity: Some(true),
            target_state: Some(true),
            trajectory_change: Some(0),
            offset_applied: None,
            baro_quality: None,
            es_in: Some(false),
            uat_in: Some(false),
            single_antenna: Some(false),
            b2_low: None,
            size: None,
            antenna_offset: None,
        }
    );
}

#[test]
fn a_light_aircraft_with_one_antenna_and_a_receiver() {
    let status = decode("8DA8B3D4F8100006005AB8EB50AF");
    assert_eq!(status.es_in, Some(true));
    assert_eq!(status.single_antenna, Some(true));
    assert_eq!(status.tcas_operational, Some(false));
    assert_eq!((status.nic_a, status.nac_p), (Some(true), Some(10)));
}

#[test]
fn an_airliner_on_the_surface() {
    // The same airliner: up to 45 by 39.5 m, antenna on the axis 14 m behind the nose.
    assert_eq!(
        decode("8C486257F9008602884A38A97BC2"),
        OperationalStatus {
            on_surface: true,
            version: 2,
            capability_class: 0x0086,
            operational_mode: 0x0288,
            nic_a: Some(false),
            nic_c: Some(false),
            nac_p: Some(10),
            nac_v: Some(4),
            gva: None,
            sil: Some(3),
            sil_per_sample: Some(false),
            sda: Some(2),
            nic_baro: None,
            surface_heading: Some(true),
            magnetic_heading: Some(false),
            tcas_operational: None,
            tcas_ra: Some(false),
            ident: Some(false),
            atc_services: None,
            traffic_display: None,
            air_velocity: None,
            target_state: None,
            trajectory_change: None,
            offset_applied: Some(false),
            baro_quality: None,
            es_in: Some(false),
            uat_in: Some(false),
            single_antenna: Some(false),
            b2_low: Some(false),
            size: Some(SizeCode(6)),
            antenna_offset: Some(AntennaOffset(0x88)),
        }
    );
    assert_eq!(SizeCode(6).length_and_width_dm(), Some((450, 395)));
    let offset = AntennaOffset(0x88);
    let on_axis = LateralOffset {
        right: true,
        metres: 0,
    };
    assert_eq!(offset.lateral(), Some(on_axis));
    assert_eq!(offset.behind_nose_m(), Some(14));
}

#[test]
fn the_tcas_bit_was_turned_round_in_version_2() {
    for (version, bits, operational) in [
        (0, &[][..], Some(true)),
        (0, &[11][..], Some(false)),
        (0, &[10][..], None),
        (1, &[][..], Some(true)),
        (1, &[11][..], Some(false)),
        (2, &[][..], Some(false)),
        (2, &[11][..], Some(true)),
        (3, &[11][..], Some(true)),
        // Another layout of the capability classes.
        (2, &[10, 11][..], None),
    ] {
        let status = with_bits(0, version, bits);
        assert_eq!(status.tcas_operational, operational, "{version} {bits:?}");
    }
}

#[test]
fn each_flag_has_its_bit() {
    type Flag = fn(&OperationalStatus) -> Option<bool>;
    let flags: [(u8, usize, Flag); 15] = [
        (0, 12, |s| s.es_in),
        (0, 19, |s| s.uat_in),
        (0, 27, |s| s.tcas_ra),
        (0, 28, |s| s.ident),
        (0, 30, |s| s.single_antenna),
        (0, 44, |s| s.nic_a),
        (0, 53, |s| s.nic_baro),
        (0, 54, |s| s.magnetic_heading),
        (0, 55, |s| s.sil_per_sample),
        (1, 12, |s| s.es_in),
        (1, 15, |s| s.b2_low),
        (1, 16, |s| s.uat_in),
        (1, 20, |s| s.nic_c),
        (1, 44, |s| s.nic_a),
        (1, 53, |s| s.surface_heading),
    ];
    for (subtype, bit, flag) in flags {
        assert_eq!(
            flag(&with_bits(subtype, 2, &[bit])),
            Some(true),
            "bit {bit}"
        );
        assert_eq!(flag(&with_bits(subtype, 2, &[])), Some(false), "bit {bit}");
        assert_eq!(flag(&with_bits(subtype, 0, &[bit])), None, "bit {bit}");
    }
}

#[test]
fn version_0_tells_two_classes_alone() {
    let every_bit: std::vec::Vec<usize> = (13..=40).chain(44..=56).collect();
    for subtype in [0, 1] {
        let none = with_bits(subtype, 0, &[]);
        let all = with_bits(subtype, 0, &every_bit);
        let raw = OperationalStatus {
            capability_class: all.capability_class,
            operational_mode: all.operational_mode,
            ..none
        };
        assert_eq!(all, raw);
        assert_eq!(none.version, 0);
        assert_eq!((none.nac_p, none.sil, none.ident), (None, None, None));
        let in_the_air = subtype == 0;
        assert_eq!(none.traffic_display, in_the_air.then_some(false));
        assert_eq!(none.tcas_operational, in_the_air.then_some(true));
    }
    let both = with_bits(0, 0, &[11, 12]);
    assert_eq!(both.traffic_display, Some(true));
    assert_eq!(both.tcas_operational, Some(false));
}

#[test]
fn capabilities_of_versions_1_and_2() {
    type Flag = fn(&OperationalStatus) -> Option<bool>;
    let flags: [(u8, u8, usize, Flag); 8] = [
        (0, 1, 12, |s| s.traffic_display),
        (1, 1, 12, |s| s.traffic_display),
        (0, 1, 29, |s| s.atc_services),
        (0, 1, 15, |s| s.air_velocity),
        (0, 2, 15, |s| s.air_velocity),
        (0, 2, 16, |s| s.target_state),
        (1, 1, 11, |s| s.offset_applied),
        (1, 2, 11, |s| s.offset_applied),
    ];
    for (subtype, version, bit, flag) in flags {
        assert_eq!(flag(&with_bits(subtype, version, &[bit])), Some(true));
        assert_eq!(flag(&with_bits(subtype, version, &[])), Some(false));
        // Another layout of classes and modes.
        assert_eq!(flag(&with_bits(subtype, version, &[10, 26, bit])), None);
    }
    let status = with_bits(0, 1, &[17, 49]);
    assert_eq!(
        (status.trajectory_change, status.baro_quality),
        (Some(2), Some(2))
    );
    let status = with_bits(0, 2, &[18, 49]);
    assert_eq!(
        (status.trajectory_change, status.baro_quality),
        (Some(1), None)
    );
}

#[test]
fn version_1_lacks_what_version_2_brought() {
    let status = with_bits(0, 1, &[12, 19, 30, 31, 45, 49, 52, 53]);
    assert_eq!(status.es_in, None);
    assert_eq!(status.uat_in, None);
    assert_eq!(status.single_antenna, None);
    assert_eq!(status.sda, None);
    assert_eq!(status.gva, None);
    assert_eq!(status.sil_per_sample, None);
    assert_eq!((status.nac_p, status.sil), (Some(8), Some(1)));
    assert_eq!(status.nic_baro, Some(true));
}

#[test]
fn sizes_grow_with_the_code() {
    assert_eq!(SizeCode(0).greatest_m(), None);
    let greatest: std::vec::Vec<u8> = (1..16).filter_map(|c| SizeCode(c).greatest_m()).collect();
    assert_eq!(
        greatest,
        [23, 29, 34, 35, 38, 45, 45, 55, 55, 65, 67, 75, 80, 85, 90]
    );
}

#[test]
fn antenna_offsets() {
    assert_eq!(AntennaOffset(0).lateral(), None);
    for (code, right, metres) in [
        (1, false, 2),
        (2, false, 4),
        (3, false, 6),
        (4, true, 0),
        (5, true, 2),
        (7, true, 6),
    ] {
        let lateral = LateralOffset { right, metres };
        assert_eq!(AntennaOffset(code << 5).lateral(), Some(lateral));
    }
    for (code, metres) in [(0, None), (1, None), (2, Some(2)), (31, Some(60))] {
        assert_eq!(AntennaOffset(code).behind_nose_m(), metres);
    }
}
