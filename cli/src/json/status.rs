//! What squitters tell of the aircraft's state: emergency, advisory, target state, operational status, and the categories of quality.

use super::{Fields, advisory};
use mode_s::{
    AcasRa, EmergencyState, EmergencyStatus, OperationalStatus, SelectionSource, TargetIntent,
    TargetState, quality,
};

pub(super) fn put_emergency(status: &EmergencyStatus, fields: &mut Fields) {
    fields.put("subtype", 1);
    put_state(status.state, fields);
    if let Some(squawk) = status.squawk {
        fields.squawk(squawk);
    }
}

pub(super) fn put_advisory(told: &AcasRa, fields: &mut Fields) {
    fields.put("subtype", 2);
    advisory::put(told, fields);
    advisory::put_threat(&told.threat, fields);
}

fn put_state(state: EmergencyState, fields: &mut Fields) {
    let text = match state {
        EmergencyState::None => "none",
        EmergencyState::General => "general",
        EmergencyState::Medical => "medical",
        EmergencyState::MinimumFuel => "minimum fuel",
        EmergencyState::NoCommunications => "no communications",
        EmergencyState::UnlawfulInterference => "unlawful interference",
        EmergencyState::Downed => "downed",
        EmergencyState::Reserved => "reserved",
    };
    fields.put("emergency_state", state.code());
    fields.put("emergency_state_text", text);
}

pub(super) fn put_nac_p(nac_p: u8, fields: &mut Fields) {
    fields.put("nac_p", nac_p);
    fields.may_put("epu", quality::epu_m(nac_p));
    fields.may_put("vepu", quality::vepu_m(nac_p));
}

pub(super) fn put_nac_v(nac_v: u8, fields: &mut Fields) {
    fields.put("nac_v", nac_v);
    if let Some((horizontal, vertical)) = quality::velocity_error_cm_s(nac_v) {
        fields.put("hfom_r", f64::from(horizontal) / 100.0);
        fields.put("vfom_r", f64::from(vertical) / 100.0);
    }
}

pub(super) fn put_sil(sil: u8, fields: &mut Fields) {
    fields.put("sil", sil);
    let probability = quality::integrity_exponent(sil).map(|n| 10f64.powi(-i32::from(n)));
    fields.may_put("pe_rcu", probability);
}

const fn source(source: SelectionSource) -> &'static str {
    match source {
        SelectionSource::Mcp => "MCP/FCU",
        SelectionSource::Fms => "FMS",
        SelectionSource::Held => "held",
    }
}

pub(super) fn put_target(state: &TargetState, fields: &mut Fields) {
    fields.put("subtype", state.subtype);
    let selected = state.selected_altitude;
    fields.may_put("selected_altitude", selected.map(|told| told.altitude.0));
    let told = selected.map_or("N/A", |told| source(told.source));
    fields.put("selected_altitude_source", told);
    let tenths = state.pressure_setting_tenths;
    let hectopascals = tenths.map(|tenths| f64::from(tenths) / 10.0);
    fields.may_put("baro_pressure_setting", hectopascals);
    fields.angle("selected_heading", state.selected_heading);
    put_nac_p(state.nac_p, fields);
    put_sil(state.sil, fields);
    fields.put("nic_baro", u8::from(state.nic_baro));
    fields.may_put_bit("sil_supplement", state.sil_per_sample);
    if let Some(modes) = state.modes {
        fields.put("autopilot", modes.autopilot);
        fields.put("vnav_mode", modes.vnav);
        fields.put("altitude_hold_mode", modes.altitude_hold);
        fields.put("approach_mode", modes.approach);
        fields.put("lnav_mode", modes.lnav);
    }
    fields.put("tcas_operational", state.tcas_operational);
    fields.may_put("tcas_ra", state.tcas_ra);
    if let Some(emergency) = state.emergency {
        put_state(emergency, fields);
    }
    if let Some(intent) = &state.intent {
        put_intent(intent, fields);
    }
}

fn put_intent(intent: &TargetIntent, fields: &mut Fields) {
    fields.put("target_above_sea_level", intent.above_sea_level);
    fields.put("target_altitude_capability", intent.altitude_capability);
    fields.put("vertical_mode", intent.vertical_mode);
    fields.put("horizontal_mode", intent.horizontal_mode);
    fields.may_put("selected_angle_source", intent.angle_source.map(source));
    fields.angle("selected_track", intent.selected_track);
}

pub(super) fn put_operational(status: &OperationalStatus, fields: &mut Fields) {
    fields.put("subtype", u8::from(status.on_surface));
    fields.put("on_ground", status.on_surface);
    fields.put("version", status.version);
    fields.put("capability_class", status.capability_class);
    fields.put("operational_mode", status.operational_mode);
    if let Some(nac_p) = status.nac_p {
        put_nac_p(nac_p, fields);
    }
    if let Some(nac_v) = status.nac_v {
        put_nac_v(nac_v, fields);
    }
    if let Some(sil) = status.sil {
        put_sil(sil, fields);
    }
    fields.may_put("gva", status.gva);
    fields.may_put("gva_metres", status.gva.and_then(quality::gva_m));
    fields.may_put("sda", status.sda);
    fields.may_put("baq", status.baro_quality);
    fields.may_put("tc_capability", status.trajectory_change);
    for (name, value) in [
        ("nic_supplement_a", status.nic_a),
        ("nic_supplement_c", status.nic_c),
        ("nic_baro", status.nic_baro),
        ("sil_supplement", status.sil_per_sample),
        ("hrd", status.magnetic_heading),
        ("trk_hdg", status.surface_heading),
    ] {
        fields.may_put_bit(name, value);
    }
    for (name, value) in [
        ("tcas_operational", status.tcas_operational),
        ("tcas_ra", status.tcas_ra),
        ("ident_switch", status.ident),
        ("atc_services", status.atc_services),
        ("cdti", status.traffic_display),
        ("arv_capability", status.air_velocity),
        ("ts_capability", status.target_state),
        ("position_offset_applied", status.offset_applied),
        ("es1090_in", status.es_in),
        ("uat_in", status.uat_in),
        ("single_antenna", status.single_antenna),
        ("b2_low", status.b2_low),
    ] {
        fields.may_put(name, value);
    }
    put_airframe(status, fields);
}

fn put_airframe(status: &OperationalStatus, fields: &mut Fields) {
    if let Some((length, width)) = status.size.and_then(|size| size.length_and_width_dm()) {
        fields.put("length", f64::from(length) / 10.0);
        fields.put("width", f64::from(width) / 10.0);
    }
    let Some(offset) = status.antenna_offset else {
        return;
    };
    let lateral = offset.lateral().map(|lateral| {
        let metres = i32::from(lateral.metres);
        if lateral.right { metres } else { -metres }
    });
    fields.may_put("antenna_lateral", lateral);
    fields.may_put("antenna_behind_nose", offset.behind_nose_m());
}
