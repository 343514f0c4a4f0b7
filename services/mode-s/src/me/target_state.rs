//! Target state and status (TC 29, BDS 6,2): what the crew has selected, and what the autopilot does with it.
//!
//! | bits | subtype 1 (version 2) | bits | subtype 0 (version 1) |
//! |---|---|---|---|
//! | 6-7 | 1 | 6-7 | 0 |
//! | 8 | SIL supplement | 8-9 | altitude from: 1 MCP/FCU, 2 the altitude held, 3 FMS |
//! | 9 | altitude from: 0 MCP/FCU, 1 FMS | 10 | altitude is 1 above sea level, 0 flight level |
//! | 10-20 | altitude: 0 none, else less one in 32 ft | 11 | 0 (1: an older layout, not decoded) |
//! | 21-29 | pressure setting: 0 none, else less one in 0.8 hPa from 800 | 12-13, 14-15 | altitude capability, vertical mode |
//! | 30 | heading is valid | 16-25 | altitude in 100 ft from -1000 |
//! | 31-39 | heading in 360/512° | 26-27 | angle from: 0 none |
//! | | | 28-36 | angle in degrees, from 360 invalid |
//! | | | 37, 38-39 | angle is 1 track, 0 heading; horizontal mode |
//! | 40-43 | NACp | 40-43 | NACp |
//! | 44 | NICbaro | 44 | NICbaro |
//! | 45-46 | SIL | 45-46 | SIL |
//! | 47 | bits 48-50, 52, 54 are valid | 52 | TCAS is *not* operational |
//! | 48-50 | autopilot, VNAV, altitude hold | 53 | RA is active |
//! | 52-54 | approach, TCAS operational, LNAV | 54-56 | emergency state |
//!
//! Altitude capability: 0 what is held, 1 also by the panel, 2 also by FMS. Modes: 0 unknown, 1 acquiring, 2 capturing or holding.
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
    /// What is being held (version 1 only).
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

/// What version 1 tells beyond the later layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TargetIntent {
    /// The target altitude is above sea level; otherwise a flight level.
    pub above_sea_level: bool,
    /// Which target altitudes the aircraft can tell, 0-2; 3 is reserved.
    pub altitude_capability: u8,
    /// Vertical mode: 0 unknown, 1 acquiring, 2 capturing or holding; 3 is reserved.
    pub vertical_mode: u8,
    /// Who selected heading or track.
    pub angle_source: Option<SelectionSource>,
    /// The selected track, of aircraft that select a track.
    pub selected_track: Option<CentiDegrees>,
    /// Horizontal mode, as the vertical one.
    pub horizontal_mode: u8,
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
    /// What only subtype 0 tells.
    pub intent: Option<TargetIntent>,
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
        intent: None,
    }
}

fn version_1(me: MeBits) -> TargetState {
    // Steps of 100 ft from -1000 ft.
    let altitude = AltitudeFt(me.bits(16, 25) as i32 * 100 - 1_000);
    let angle_source = source(me.bits(26, 27));
    let degrees = me.bits(28, 36) as u16;
    let angle = (angle_source.is_some() && degrees < 360).then_some(CentiDegrees(degrees * 100));
    let is_track = me.bit(37);
    TargetState {
        subtype: 0,
        selected_altitude: source(me.bits(8, 9))
            .map(|source| SelectedAltitude { source, altitude }),
        pressure_setting_tenths: None,
        selected_heading: angle.filter(|_| !is_track),
        nac_p: me.bits(40, 43) as u8,
        nic_baro: me.bit(44),
        sil: me.bits(45, 46) as u8,
        sil_per_sample: None,
        modes: None,
        tcas_operational: !me.bit(52),
        tcas_ra: Some(me.bit(53)),
        emergency: Some(EmergencyState::of_code(me.bits(54, 56) as u8)),
        intent: Some(TargetIntent {
            above_sea_level: me.bit(10),
            altitude_capability: me.bits(12, 13) as u8,
            vertical_mode: me.bits(14, 15) as u8,
            angle_source,
            selected_track: angle.filter(|_| is_track),
            horizontal_mode: me.bits(38, 39) as u8,
        }),
    }
}

/// Who selected, by the code of version 1; 0 is nothing selected.
const fn source(code: u32) -> Option<SelectionSource> {
    match code {
        1 => Some(SelectionSource::Mcp),
        2 => Some(SelectionSource::Held),
        3 => Some(SelectionSource::Fms),
        _ => None,
    }
}

#[cfg(test)]
#[path = "target_state_tests.rs"]
mod tests;
