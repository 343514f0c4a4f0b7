//! Target state: a published frame, frames of a recorded flight, and each field in its bits.

use super::*;
use crate::frame::tests::frame;

/// An ME field of TC 29 with these bits set.
fn with_bits(bits: &[usize]) -> MeBits {
    let mut me = [29 << 3, 0, 0, 0, 0, 0, 0];
    for bit in bits {
        me[(bit - 1) / 8] |= 0x80 >> ((bit - 1) % 8);
    }
    MeBits::new(me)
}

#[test]
fn the_published_frame() {
    // A frame of pyModeS's tests: 16 992 ft by MCP/FCU, 1012.8 hPa, 66.8°, autopilot with VNAV and LNAV, TCAS operational.
    let state = TargetState::decode(frame("8DA05629EA21485CBF3F8CADAEEB").me()).unwrap();
    assert_eq!(
        state,
        TargetState {
            subtype: 1,
            selected_altitude: Some(SelectedAltitude {
                source: SelectionSource::Mcp,
                altitude: AltitudeFt(16_992)
            }),
            pressure_setting_tenths: Some(10_128),
            selected_heading: Some(CentiDegrees(6_680)),
            nac_p: 9,
            nic_baro: true,
            sil: 3,
            sil_per_sample: Some(false),
            modes: Some(AutopilotModes {
                autopilot: true,
                vnav: true,
                altitude_hold: false,
                approach: false,
                lnav: true,
            }),
            tcas_operational: true,
            tcas_ra: None,
            emergency: None,
            intent: None,
        }
    );
}

#[test]
fn zero_is_no_altitude_and_no_pressure_and_one_is_the_lowest() {
    let state = TargetState::decode(with_bits(&[7])).unwrap();
    assert_eq!(state.selected_altitude, None);
    assert_eq!(state.pressure_setting_tenths, None);
    assert_eq!(state.selected_heading, None);
    assert_eq!(state.modes, None);
    let state = TargetState::decode(with_bits(&[7, 9, 20, 29])).unwrap();
    let lowest = SelectedAltitude {
        source: SelectionSource::Fms,
        altitude: AltitudeFt(0),
    };
    assert_eq!(state.selected_altitude, Some(lowest));
    assert_eq!(state.pressure_setting_tenths, Some(8_000));
}

#[test]
fn heading_is_a_whole_turn_of_512_steps() {
    for (bits, heading) in [
        (&[7, 30][..], 0),
        (&[7, 30, 39][..], 70),
        (&[7, 30, 31][..], 18_000),
        (&[7, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39][..], 35_930),
    ] {
        let state = TargetState::decode(with_bits(bits)).unwrap();
        assert_eq!(state.selected_heading, Some(CentiDegrees(heading)));
    }
    let invalid = TargetState::decode(with_bits(&[7, 39])).unwrap();
    assert_eq!(invalid.selected_heading, None);
}

#[test]
fn each_mode_has_its_bit() {
    let none = AutopilotModes {
        autopilot: false,
        vnav: false,
        altitude_hold: false,
        approach: false,
        lnav: false,
    };
    for (bit, modes) in [
        (
            48,
            AutopilotModes {
                autopilot: true,
                ..none
            },
        ),
        (49, AutopilotModes { vnav: true, ..none }),
        (
            50,
            AutopilotModes {
                altitude_hold: true,
                ..none
            },
        ),
        (51, none),
        (
            52,
            AutopilotModes {
                approach: true,
                ..none
            },
        ),
        (53, none),
        (54, AutopilotModes { lnav: true, ..none }),
    ] {
        let state = TargetState::decode(with_bits(&[7, 47, bit])).unwrap();
        assert_eq!(state.modes, Some(modes), "bit {bit}");
        assert_eq!(state.tcas_operational, bit == 53);
        let unsaid = TargetState::decode(with_bits(&[7, bit])).unwrap();
        assert_eq!(unsaid.modes, None);
    }
}

#[test]
fn version_1_has_a_layout_of_its_own() {
    // MCP, 200 steps (bits 18, 19, 22) are 19 000 ft; heading 90°; RA, emergency 1.
    let bits = [9, 18, 19, 22, 27, 30, 32, 33, 35, 53, 56];
    let state = TargetState::decode(with_bits(&bits)).unwrap();
    let altitude = SelectedAltitude {
        source: SelectionSource::Mcp,
        altitude: AltitudeFt(19_000),
    };
    assert_eq!(state.selected_altitude, Some(altitude));
    assert_eq!(state.selected_heading, Some(CentiDegrees(9_000)));
    assert!(state.tcas_operational);
    assert_eq!(state.tcas_ra, Some(true));
    assert_eq!(state.emergency, Some(EmergencyState::General));
    let no_tcas = TargetState::decode(with_bits(&[52])).unwrap();
    assert!(!no_tcas.tcas_operational);
    assert_eq!(no_tcas.selected_altitude, None);
    // A track is no heading, and an angle from 360 is none.
    for bits in [&[27, 37][..], &[27, 28, 30, 31, 33][..]] {
        let state = TargetState::decode(with_bits(bits)).unwrap();
        assert_eq!(state.selected_heading, None);
    }
}

#[test]
fn reserved_layouts_are_not_decoded() {
    for bits in [&[6][..], &[6, 7][..], &[11][..]] {
        assert_eq!(TargetState::decode(with_bits(bits)), None);
    }
}
