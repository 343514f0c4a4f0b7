//! The range of every field of every register, as [`crate::possible`] has it for messages.
//!
//! | register | field | from | to | unit |
//! |---|---|---|---|---|
//! | 4,0 | altitudes | 0 | 65 520 | ft |
//! | 4,0 | pressure setting | 800 | 1 209.5 | hPa |
//! | 4,4 | wind; temperature | 0; -256 | 511; 255.75 | kt; °C |
//! | 4,4, 4,5 | pressure | 0 | 2 047 | hPa |
//! | 4,5 | temperature; radio height | -128; 0 | 127.75; 65 520 | °C; ft |
//! | 5,0 | roll; turn rate | -90; -16 | 89.9; 15.97 | °; ° a second |
//! | 5,0 | speeds | 0 | 2 046 | kt |
//! | 6,0 | IAS; Mach | 0 | 1 023; 4.092 | kt |
//! | 6,0 | vertical rates | -16 384 | 16 352 | ft/min |
//!
//! These are the ends of the fields. [`super::infer`] finds only registers within narrower ones.

use super::Register;
use super::bds44::Wind;
use crate::angle::CentiDegrees;
use crate::possible::{
    Impossible, advisory_is_possible, callsign_is_possible, may_be_within, within,
};

/// Whether every field of a register holds a possible value.
pub fn possible(register: &Register) -> Result<(), Impossible> {
    let feet = |altitude: Option<crate::AltitudeFt>| altitude.map(|feet| feet.0);
    let angle =
        |angle: Option<CentiDegrees>| may_be_within("angle", angle.map(|angle| angle.0), 0, 35_999);
    match register {
        Register::DataLinkCapability(capability) => {
            within(
                "version of the subnetwork",
                capability.subnetwork_version(),
                0,
                127,
            )?;
            within("uplink throughput", capability.uplink_throughput(), 0, 7)?;
            within(
                "downlink throughput",
                capability.downlink_throughput(),
                0,
                15,
            )?;
            within("version of ACAS", capability.acas_version(), 0, 3)
        }
        Register::GicbCapability(capability) => within(
            "announced registers",
            capability.0 as i32,
            1 << 17,
            0xFF_FFFF,
        ),
        Register::AircraftIdentification(told) => callsign_is_possible(told.callsign),
        Register::AcasRa(advisory) => advisory_is_possible(advisory),
        Register::SelectedVerticalIntention(told) => {
            may_be_within("MCP altitude", feet(told.mcp_altitude), 0, 65_520)?;
            may_be_within("FMS altitude", feet(told.fms_altitude), 0, 65_520)?;
            may_be_within(
                "pressure setting",
                told.pressure_setting_tenths,
                8_000,
                12_095,
            )
        }
        Register::MetRoutineReport(report) => {
            within("FOM", report.source, 0, 15)?;
            if let Some(Wind { speed_kt, from }) = report.wind {
                within("wind", speed_kt, 0, 511)?;
                angle(Some(from))?;
            }
            within("temperature", report.temperature_quarters, -1_024, 1_023)?;
            may_be_within("pressure", report.pressure_hpa, 0, 2_047)?;
            may_be_within("turbulence", report.turbulence, 0, 3)?;
            may_be_within("humidity", report.humidity_64ths, 0, 63)
        }
        Register::MetHazardReport(report) => {
            for level in [
                report.turbulence,
                report.wind_shear,
                report.microburst,
                report.icing,
                report.wake_vortex,
            ] {
                may_be_within("hazard", level, 0, 3)?;
            }
            may_be_within("temperature", report.temperature_quarters, -512, 511)?;
            may_be_within("pressure", report.pressure_hpa, 0, 2_047)?;
            may_be_within("radio height", report.radio_height_ft, 0, 65_520)
        }
        Register::TrackAndTurn(turn) => {
            may_be_within("roll", turn.roll_centidegrees(), -9_000, 8_999)?;
            angle(turn.track)?;
            may_be_within("ground speed", turn.ground_speed_kt, 0, 2_046)?;
            may_be_within("rate of turn", turn.track_rate_32nds, -512, 511)?;
            may_be_within("true airspeed", turn.true_airspeed_kt, 0, 2_046)
        }
        Register::HeadingAndSpeed(speed) => {
            angle(speed.heading)?;
            may_be_within("IAS", speed.indicated_airspeed_kt, 0, 1_023)?;
            may_be_within("Mach", speed.mach_thousandths, 0, 4_092)?;
            for rate in [speed.baro_rate_fpm, speed.inertial_rate_fpm] {
                may_be_within("vertical rate of 6,0", rate, -16_384, 16_352)?;
            }
            Ok(())
        }
    }
}
