//! Target state and status (TC 29, BDS 6,2): what the crew has selected, and what the autopilot does with it.
//!
//! | bits | subtype 1 (version 2) | bits | subtype 0 (version 1) |
//! |---|---|---|---|
//! | 6-7 | 1 | 6-7 | 0 |
//! | 8 | SIL supplement | 8-9 | altitude from: 1 MCP/FCU, 2 the altitude held, 3 FMS |
//! | 9 | altitude from: 0 MCP/FCU, 1 FMS | 10 | altitude is 1 above sea level, 0 flight level |
//! | 10-20 | altitude: 0 none, else less one in 32 ft | 11 | 0 (1: an older layout, not decoded) |
//! | 21-29 | pressure setting: 0 none, else less one in 0.8 hPa from 800 | 12-15 | capability and mode |
//! | 30 | heading is valid | 16-25 | altitude in 100 ft from -1000 |
//! | 31-39 | heading in 360/512° | 26-27 | angle from: 0 none |
//! | | | 28-36 | angle in degrees, from 360 invalid |
//! | | | 37 | angle is 1 track, 0 heading |
//! | 40-43 | NACp | 40-43 | NACp |
//! | 44 | NICbaro | 44 | NICbaro |
//! | 45-46 | SIL | 45-46 | SIL |
//! | 47 | bits 48-50, 52, 54 are valid | 52 | TCAS is *not* operational |
//! | 48-50 | autopilot, VNAV, altitude hold | 53 | RA is active |
//! | 52-54 | approach, TCAS operational, LNAV | 54-56 | emergency state |
//!
//! Source: "The 1090 Megahertz Riddle", target state and status; the layout of version 1 as pyModeS documents it.

use super::emergency::EmergencyState;
use crate::altitude::AltitudeFt;
use crate::angle::CentiDegrees;
use crate::frame::MeBits;

/// Who selected an altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelectionSource {
    /// Mode control panel or flight control unit.
    Mcp,
    /// Flight management system.
    Fms,
    /// The altitude that is being held (version 1 only).
    Held,
}

/// A selected altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SelectedAltitude {
    /// Who selected it.
    pub source: SelectionSource,
    /// Its value.
    pub altitude: AltitudeFt,
}

/// What the autopilot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AutopilotModes {
    /// The autopilot is engaged.
    pub autopilot: bool,
    /// VNAV.
    pub vnav: bool,
    /// Altitude hold.
    pub altitude_hold: bool,
    /// Approach.
    pub approach: bool,
    /// LNAV.
    pub lnav: bool,
}

/// TC 29, subtypes 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TargetState {
    /// 0 or 1: which of the two layouts.
    pub subtype: u8,
    /// The selected altitude, where known.
    pub selected_altitude: Option<SelectedAltitude>,
    /// Barometric pressure setting, tenths of a hectopascal, where known; subtype 1.
    pub pressure_setting_tenths: Option<u16>,
    /// The selected heading, where known.
    pub selected_heading: Option<CentiDegrees>,
    /// NACp.
    pub nac_p: u8,
    /// NICbaro.
    pub nic_baro: bool,
    /// SIL, 0-3.
    pub sil: u8,
    /// SIL supplement: SIL is per sample, not per hour; subtype 1.
    pub sil_per_sample: Option<bool>,
    /// What the autopilot does, where valid; subtype 1.
    pub modes: Option<AutopilotModes>,
    /// TCAS is operational.
    pub tcas_operational: bool,
    /// A resolution advisory is active; subtype 0.
    pub tcas_ra: Option<bool>,
    /// The emergency state; subtype 0.
    pub emergency: Option<EmergencyState>,
}

impl TargetState {
    /// Decodes an ME field of TC 29; `None` for the layouts that are reserved.
    pub fn decode(me: MeBits) -> Option<TargetState> {
        match me.bits(6, 7) {
            0 if !me.bit(11) => Some(version_1(me)),
            1 => Some(version_2(me)),
            _ => None,
        }
    }
}

fn version_2(me: MeBits) -> TargetState {
    let source = if me.bit(9) {
        SelectionSource::Fms
    } else {
        SelectionSource::Mcp
    };
    TargetState {
        subtype: 1,
        selected_altitude: me.bits(10, 20).checked_sub(1).map(|steps| {
            let altitude = AltitudeFt(steps as i32 * 32);
            SelectedAltitude { source, altitude }
        }),
        pressure_setting_tenths: me
            .bits(21, 29)
            .checked_sub(1)
            .map(|steps| 8_000 + 8 * steps as u16),
        selected_heading: me
            .bit(30)
            .then(|| CentiDegrees(((me.bits(31, 39) * 36_000 + 256) / 512) as u16)),
        nac_p: me.bits(40, 43) as u8,
        nic_baro: me.bit(44),
        sil: me.bits(45, 46) as u8,
        sil_per_sample: Some(me.bit(8)),
        modes: me.bit(47).then(|| AutopilotModes {
            autopilot: me.bit(48),
            vnav: me.bit(49),
            altitude_hold: me.bit(50),
            approach: me.bit(52),
            lnav: me.bit(54),
        }),
        tcas_operational: me.bit(53),
        tcas_ra: None,
        emergency: None,
    }
}

fn version_1(me: MeBits) -> TargetState {
    let source = match me.bits(8, 9) {
        1 => Some(SelectionSource::Mcp),
        2 => Some(SelectionSource::Held),
        3 => Some(SelectionSource::Fms),
        _ => None,
    };
    // Steps of 100 ft from -1000 ft.
    let altitude = AltitudeFt(me.bits(16, 25) as i32 * 100 - 1_000);
    let angle = me.bits(28, 36) as u16;
    let is_heading = me.bits(26, 27) != 0 && !me.bit(37);
    TargetState {
        subtype: 0,
        selected_altitude: source.map(|source| SelectedAltitude { source, altitude }),
        pressure_setting_tenths: None,
        selected_heading: (is_heading && angle < 360).then_some(CentiDegrees(angle * 100)),
        nac_p: me.bits(40, 43) as u8,
        nic_baro: me.bit(44),
        sil: me.bits(45, 46) as u8,
        sil_per_sample: None,
        modes: None,
        tcas_operational: !me.bit(52),
        tcas_ra: Some(me.bit(53)),
        emergency: Some(EmergencyState::of_code(me.bits(54, 56) as u8)),
    }
}

#[cfg(test)]
#[path = "target_state_tests.rs"]
mod tests;
