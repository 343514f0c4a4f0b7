//! Published registers, what strikes a candidate out, and any bytes at all.

use super::*;
use crate::altitude::AltitudeFt;
use crate::angle::CentiDegrees;
use crate::bds::bds17::GicbCapability;
use crate::frame::tests::frame;
use proptest::prelude::*;

fn mb(hex: &str) -> MeBits {
    frame(hex).me()
}

#[test]
fn published_registers_are_found() {
    for (hex, bds, altitude) in [
        ("A800178D10010080F50000D5893C", 0x10, None),
        ("A0000638FA81C10000000081A92F", 0x17, None),
        ("A000083E202CC371C31DE0AA1CCF", 0x20, None),
        ("A000029C85E42F313000007047D3", 0x40, None),
        ("A0001692185BD5CF400000DFC696", 0x44, Some(35_000)),
        ("A000139381951536E024D4CCF6B5", 0x50, None),
        ("A00004128F39F91A7E27C46ADC21", 0x60, None),
    ] {
        let known = Known {
            altitude: altitude.map(AltitudeFt),
            // Weather has one agreement alone, the temperature; the announcement makes up for the other.
            announced: altitude.map(|_| GicbCapability(0xFF_FFFF)),
            ..Known::NOTHING
        };
        let found = infer(mb(hex), &known)
            .found()
            .map(|register| register.bds());
        assert_eq!(found, Some(Bds(bds)), "{hex}");
    }
}

#[test]
fn zeros_are_empty_and_noise_is_unknown() {
    assert_eq!(
        infer(MeBits::new([0; 7]), &Known::NOTHING),
        Inference::Empty
    );
    // A value behind each status bit of 0, and no mark.
    let noise = MeBits::new([0x7F, 0xF7, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF]);
    assert_eq!(infer(noise, &Known::NOTHING), Inference::Unknown);
}

#[test]
fn a_register_that_is_not_announced_is_not_found() {
    let hex = "A00004128F39F91A7E27C46ADC21";
    let known = Known {
        announced: Some(GicbCapability(0xFF_FFFE)),
        ..Known::NOTHING
    };
    assert_eq!(infer(mb(hex), &known).found(), None);
}

/// Frames of the long flight whose numbers are possible in both registers, with the ADS-B velocity just before: it decides.
#[test]
fn what_is_known_decides_between_5_0_and_6_0() {
    for (hex, bds, ground_speed_kt, track, vertical_rate_fpm) in [
        ("A8200800F299330F20840F9DD6E3", 0x60, 156, 32_284, 512),
        ("A8000800FC3A2D20208C12377821", 0x60, 338, 35_285, 576),
        ("A8000800FFD821077FDC22F9B858", 0x50, 58, 18_296, 0),
        ("A8000800FFB825073FFC21ADA84B", 0x50, 55, 18_312, 0),
    ] {
        match infer(mb(hex), &Known::NOTHING) {
            Inference::Ambiguous(candidates) => {
                assert!(candidates.iter().eq([Bds(0x50), Bds(0x60)]), "{hex}");
            }
            other => panic!("{hex}: {other:?}"),
        }
        let known = Known {
            ground_speed_kt: Some(ground_speed_kt),
            track: Some(CentiDegrees(track)),
            vertical_rate_fpm: Some(vertical_rate_fpm),
            ..Known::NOTHING
        };
        let found = infer(mb(hex), &known)
            .found()
            .map(|register| register.bds());
        assert_eq!(found, Some(Bds(bds)), "{hex}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_give_possible_registers(bytes in prop::array::uniform7(any::<u8>()), feet in prop::option::of(-1_200..60_000)) {
        let mb = MeBits::new(bytes);
        for bds in Bds::DECODED {
            if let Some(register) = Register::decode(bds, mb) {
                prop_assert_eq!(register.bds(), bds);
                prop_assert_eq!(crate::bds::possible(&register), Ok(()));
            }
        }
        let known = Known { altitude: feet.map(AltitudeFt), ..Known::NOTHING };
        if let Some(register) = infer(mb, &known).found() {
            prop_assert_eq!(Register::decode(register.bds(), mb), Some(register));
        }
    }

    /// Few bits set, so that status bits are 0 often and layouts fit.
    #[test]
    fn sparse_bytes_give_possible_registers(places in prop::collection::vec(0usize..56, 0..9)) {
        let mut bytes = [0u8; 7];
        for place in places {
            bytes[place / 8] |= 0x80 >> (place % 8);
        }
        let mb = MeBits::new(bytes);
        for bds in Bds::DECODED {
            if let Some(register) = Register::decode(bds, mb) {
                prop_assert_eq!(crate::bds::possible(&register), Ok(()));
            }
        }
        infer(mb, &Known::NOTHING);
    }
}
