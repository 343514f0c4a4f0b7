//! Comm-B registers.

use super::{Fields, advisory, squitter};
use mode_s::bds::bds10::DataLinkCapability;
use mode_s::bds::bds40::{SelectedVerticalIntention, TargetSource};
use mode_s::bds::bds44::MetRoutineReport;
use mode_s::bds::bds45::MetHazardReport;
use mode_s::bds::bds50::TrackAndTurn;
use mode_s::bds::bds60::HeadingAndSpeed;
use mode_s::{Bds, Register};

/// A register as people write it.
pub(super) fn name(Bds(number): Bds) -> String {
    format!("{:X},{:X}", number >> 4, number & 15)
}

pub(super) fn put(register: &Register, fields: &mut Fields) {
    fields.put("bds", name(register.bds()));
    match register {
        Register::DataLinkCapability(told) => put_capability(told, fields),
        Register::GicbCapability(told) => {
            let names: Vec<String> = told.registers().map(name).collect();
            fields.put("supported_bds", names);
        }
        Register::AircraftIdentification(told) => {
            fields.may_put("callsign", told.callsign.as_ref().map(squitter::text));
        }
        Register::AcasRa(told) => {
            advisory::put(told, fields);
            advisory::put_threat(&told.threat, fields);
        }
        Register::SelectedVerticalIntention(told) => put_intention(told, fields),
        Register::MetRoutineReport(report) => put_routine(report, fields),
        Register::MetHazardReport(report) => put_hazard(report, fields),
        Register::TrackAndTurn(turn) => put_turn(turn, fields),
        Register::HeadingAndSpeed(speed) => put_speed(speed, fields),
    }
}

fn put_capability(told: &DataLinkCapability, fields: &mut Fields) {
    for (bit, name) in [
        (9, "config"),
        (15, "overlay_command_capability"),
        (16, "acas_operational"),
        (24, "transponder_level5"),
        (25, "mode_s_specific_services"),
        (33, "aircraft_identification_capability"),
        (34, "squitter_capability"),
        (35, "surveillance_identifier_code"),
        (36, "common_usage_gicb_capability"),
        (37, "acas_hybrid_surveillance"),
        (38, "acas_resolution_advisory"),
    ] {
        fields.put(name, told.bit(bit));
    }
    fields.put("mode_s_subnetwork_version", told.subnetwork_version());
    fields.put("uplink_elm_throughput", told.uplink_throughput());
    fields.put("downlink_elm_throughput", told.downlink_throughput());
    fields.put("acas_rtca_version", told.acas_version());
    fields.put("dte_status", told.terminals);
}

fn put_intention(told: &SelectedVerticalIntention, fields: &mut Fields) {
    let feet = |altitude: Option<mode_s::AltitudeFt>| altitude.map(|feet| feet.0);
    fields.may_put("selected_altitude_mcp", feet(told.mcp_altitude));
    fields.may_put("selected_altitude_fms", feet(told.fms_altitude));
    let tenths = told.pressure_setting_tenths;
    let hectopascals = tenths.map(|tenths| f64::from(tenths) / 10.0);
    fields.may_put("baro_pressure_setting", hectopascals);
    if let Some(modes) = told.modes {
        fields.put("vnav_mode", modes.vnav);
        fields.put("altitude_hold_mode", modes.altitude_hold);
        fields.put("approach_mode", modes.approach);
    }
    let source = told.target_source.map(|source| match source {
        TargetSource::Unknown => "unknown",
        TargetSource::AircraftAltitude => "aircraft_altitude",
        TargetSource::Mcp => "mcp_fcu",
        TargetSource::Fms => "fms",
    });
    fields.may_put("target_altitude_source", source);
}

fn put_routine(report: &MetRoutineReport, fields: &mut Fields) {
    fields.put("figure_of_merit", report.source);
    if let Some(wind) = report.wind {
        fields.put("wind_speed", wind.speed_kt);
        fields.angle("wind_direction", Some(wind.from));
    }
    put_temperature(Some(report.temperature_quarters), fields);
    fields.may_put("static_pressure", report.pressure_hpa);
    fields.may_put("turbulence", report.turbulence);
    let parts = report.humidity_64ths;
    let per_cent = parts.map(|parts| f64::from(parts) * 100.0 / 64.0);
    fields.may_put("humidity", per_cent);
}

fn put_hazard(report: &MetHazardReport, fields: &mut Fields) {
    for (name, level) in [
        ("turbulence", report.turbulence),
        ("wind_shear", report.wind_shear),
        ("microburst", report.microburst),
        ("icing", report.icing),
        ("wake_vortex", report.wake_vortex),
    ] {
        fields.may_put(name, level);
    }
    put_temperature(report.temperature_quarters, fields);
    fields.may_put("static_pressure", report.pressure_hpa);
    fields.may_put("radio_height", report.radio_height_ft);
}

fn put_temperature(quarters: Option<i16>, fields: &mut Fields) {
    let celsius = quarters.map(|quarters| f64::from(quarters) / 4.0);
    fields.may_put("static_air_temperature", celsius);
}

fn put_turn(turn: &TrackAndTurn, fields: &mut Fields) {
    let roll = turn.roll_steps.map(|steps| f64::from(steps) * 45.0 / 256.0);
    fields.may_put("roll", roll);
    fields.angle("true_track", turn.track);
    fields.may_put("groundspeed", turn.ground_speed_kt);
    let rate = turn.track_rate_32nds.map(|parts| f64::from(parts) / 32.0);
    fields.may_put("track_rate", rate);
    fields.may_put("true_airspeed", turn.true_airspeed_kt);
}

fn put_speed(speed: &HeadingAndSpeed, fields: &mut Fields) {
    fields.angle("magnetic_heading", speed.heading);
    fields.may_put("indicated_airspeed", speed.indicated_airspeed_kt);
    let mach = speed.mach_thousandths.map(|parts| f64::from(parts) / 1e3);
    fields.may_put("mach", mach);
    fields.may_put("baro_vertical_rate", speed.baro_rate_fpm);
    fields.may_put("inertial_vertical_rate", speed.inertial_rate_fpm);
}
