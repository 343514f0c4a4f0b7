//! What rs1090 0.7 reads in a frame. By its own account it began as a fork of adsb_deku and was revised throughout since.

use crate::view::{Field, Said, View};
use mode_s::Frame;
use rs1090::decode::adsb::{ADSB, ME};
use rs1090::decode::bds::bds05::{AirbornePosition, Source};
use rs1090::decode::bds::bds06::SurfacePosition;
use rs1090::decode::bds::bds09::{
    AirborneVelocity, AirborneVelocitySubType, AirspeedType, VerticalRateSource,
};
use rs1090::decode::bds::bds61::AircraftStatusType;
use rs1090::decode::bds::bds62::{AltSource, TargetStateAndStatusInformation};
use rs1090::decode::bds::bds65::{
    ADSBVersionAirborne, ADSBVersionSurface, AircraftOperationStatus,
};
use rs1090::decode::cpr::CPRFormat;
use rs1090::decode::{DF, DownlinkRequest, Message};

/// The message, where rs1090 takes the frame.
pub fn message(frame: &Frame) -> Option<Message> {
    Message::try_from(frame.bytes()).ok()
}

/// The fields; `None` where rs1090 refuses the frame.
pub fn view(frame: &Frame) -> Option<View> {
    let message = message(frame)?;
    let mut view = View::from([(Field::Residual, Said::Whole(message.crc.into()))]);
    let mut say = |field, said| {
        view.insert(field, said);
    };
    let df = match &message.df {
        DF::ShortAirAirSurveillance {
            vs,
            cc,
            sl,
            ri,
            ac,
            ap,
            ..
        } => {
            say(Field::CrossLink, Said::Whole((*cc).into()));
            say(Field::SensitivityLevel, Said::Whole((*sl).into()));
            say(Field::ReplyInformation, Said::Whole((*ri).into()));
            say(Field::VerticalStatus, Said::Whole((*vs).into()));
            say(Field::Altitude, Said::whole(ac.0));
            say(Field::Address, Said::Whole(ap.0.into()));
            0
        }
        DF::SurveillanceAltitudeReply {
            fs, dr, um, ac, ap, ..
        } => {
            say(Field::DownlinkRequest, request(*dr));
            say(Field::UtilityInterrogator, Said::Whole(um.iis.into()));
            say(Field::UtilityReservation, Said::Whole(um.ids as i64));
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Altitude, Said::whole(ac.0));
            say(Field::Address, Said::Whole(ap.0.into()));
            4
        }
        DF::SurveillanceIdentityReply {
            fs, dr, um, id, ap, ..
        } => {
            say(Field::DownlinkRequest, request(*dr));
            say(Field::UtilityInterrogator, Said::Whole(um.iis.into()));
            say(Field::UtilityReservation, Said::Whole(um.ids as i64));
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Squawk, Said::Text(id.to_string()));
            say(Field::Address, Said::Whole(ap.0.into()));
            5
        }
        DF::AllCallReply {
            capability, icao, ..
        } => {
            say(Field::Capability, Said::Whole(*capability as i64));
            say(Field::Address, Said::Whole(icao.0.into()));
            11
        }
        DF::LongAirAirSurveillance {
            vs, sl, ri, ac, ap, ..
        } => {
            say(Field::SensitivityLevel, Said::Whole((*sl).into()));
            say(Field::ReplyInformation, Said::Whole((*ri).into()));
            say(Field::VerticalStatus, Said::Whole((*vs).into()));
            say(Field::Altitude, Said::whole(ac.0));
            say(Field::Address, Said::Whole(ap.0.into()));
            16
        }
        DF::ExtendedSquitterADSB(ADSB {
            capability,
            icao24,
            message,
            ..
        }) => {
            say(Field::Capability, Said::Whole(*capability as i64));
            say(Field::Address, Said::Whole(icao24.0.into()));
            view.append(&mut me(message));
            17
        }
        DF::ExtendedSquitterTisB { cf, .. } => {
            say(Field::Address, Said::Whole(cf.aa.0.into()));
            view.append(&mut me(&cf.me));
            18
        }
        DF::ExtendedSquitterMilitary { .. } => 19,
        DF::CommBAltitudeReply {
            fs, dr, um, ac, ap, ..
        } => {
            say(Field::DownlinkRequest, request(*dr));
            say(Field::UtilityInterrogator, Said::Whole(um.iis.into()));
            say(Field::UtilityReservation, Said::Whole(um.ids as i64));
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Altitude, Said::whole(ac.0));
            say(Field::Address, Said::Whole(ap.0.into()));
            20
        }
        DF::CommBIdentityReply {
            fs, dr, um, id, ap, ..
        } => {
            say(Field::DownlinkRequest, request(*dr));
            say(Field::UtilityInterrogator, Said::Whole(um.iis.into()));
            say(Field::UtilityReservation, Said::Whole(um.ids as i64));
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Squawk, Said::Text(id.to_string()));
            say(Field::Address, Said::Whole(ap.0.into()));
            21
        }
        DF::CommDExtended { .. } => 24,
    };
    view.insert(Field::Df, Said::Whole(df));
    Some(view)
}

/// DR: what it has no name for is one to it.
fn request(request: DownlinkRequest) -> Said {
    Said::Whole(match request {
        DownlinkRequest::Unknown => 31,
        known => known as i64,
    })
}

fn me(me: &ME) -> View {
    let mut view = View::new();
    let type_code = match me {
        ME::NoPosition(_) => 0,
        ME::BDS08 { id, inner } => {
            view.insert(Field::Category, Said::Whole(inner.ca.into()));
            view.insert(Field::Callsign, callsign(&inner.callsign));
            *id
        }
        ME::BDS06 { tc, inner } => {
            view.append(&mut surface(inner));
            *tc
        }
        ME::BDS05 { tc, inner } => {
            view.append(&mut airborne(inner));
            *tc
        }
        ME::BDS09(inner) => {
            view.append(&mut velocity(inner));
            19
        }
        ME::Reserved0(_) => 23,
        ME::SurfaceSystemStatus(_) => 24,
        ME::Reserved1 { _id, .. } => *_id,
        ME::BDS61(status) => {
            if status.subtype == AircraftStatusType::EmergencyPriorityStatus {
                let state = status.emergency_state as i64;
                view.insert(Field::Emergency, Said::Whole(state));
                view.insert(Field::Squawk, Said::Text(status.squawk.to_string()));
            }
            28
        }
        ME::BDS62(state) => {
            if state.subtype == 1 {
                view.append(&mut target(state));
            }
            29
        }
        ME::AircraftOperationalCoordination(_) => 30,
        ME::BDS65(status) => {
            view.append(&mut operational(status));
            31
        }
    };
    view.insert(Field::TypeCode, Said::Whole(type_code.into()));
    view
}

/// Its selected altitude is rounded down to hundreds of feet, so it is not compared.
fn target(state: &TargetStateAndStatusInformation) -> View {
    let is_fms = state
        .selected_altitude
        .map(|_| state.alt_source == AltSource::FMS);
    View::from([
        (Field::SelectedByFms, Said::whole(is_fms)),
        (
            Field::PressureSetting,
            Said::real(state.barometric_setting.map(f64::from)),
        ),
        (
            Field::SelectedHeading,
            Said::real(state.selected_heading.map(f64::from)),
        ),
        (Field::NacP, Said::Whole(state.nac_p.into())),
        (Field::NicBaro, Said::Whole(state.nic_baro.into())),
        (Field::Sil, Said::Whole(state.sil.into())),
        (Field::Autopilot, Said::whole(state.autopilot)),
        (Field::Vnav, Said::whole(state.vnav_mode)),
        (Field::AltitudeHold, Said::whole(state.alt_hold)),
        (Field::Approach, Said::whole(state.approach_mode)),
        (
            Field::TcasOperational,
            Said::Whole(state.tcas_operational.into()),
        ),
        (Field::Lnav, Said::whole(state.lnav_mode)),
    ])
}

/// Both logs hold version 2 alone. It keeps the operational modes to itself.
fn operational(status: &AircraftOperationStatus) -> View {
    match status {
        AircraftOperationStatus::Airborne(status) => {
            let class = &status.capability_class;
            let version = status.version.version_number();
            let mut view = View::from([
                (Field::Version, Said::Whole(version.into())),
                (Field::TcasOperational, Said::Whole(class.acas.into())),
                (Field::EsIn, Said::Whole(class.cdti.into())),
                (Field::AirVelocity, Said::Whole(class.arv.into())),
                (Field::TargetStateReport, Said::Whole(class.ts.into())),
                (Field::TrajectoryChange, Said::Whole(class.tc.into())),
            ]);
            if let ADSBVersionAirborne::DOC9871AppendixC(v2) = &status.version {
                for (field, value) in [
                    (Field::NicA, v2.nic_a),
                    (Field::NacP, v2.nac_p),
                    (Field::Gva, v2.geometry_vertical_accuracy),
                    (Field::Sil, v2.sil),
                    (Field::NicBaro, v2.barometric_altitude_integrity),
                    (Field::MagneticHeading, v2.horizontal_reference_direction),
                    (Field::SilSupplement, v2.sil_s),
                ] {
                    view.insert(field, Said::Whole(value.into()));
                }
            }
            view
        }
        AircraftOperationStatus::Surface(status) => {
            let class = &status.capability_class;
            let mut view = View::from([
                (Field::OffsetApplied, Said::Whole(class.poe.into())),
                (Field::EsIn, Said::Whole(class.es1090.into())),
                (Field::B2Low, Said::Whole(class.b2_low.into())),
                (Field::UatIn, Said::Whole(class.uat_in.into())),
                (Field::Nacv, Said::Whole(class.nac_v.into())),
                (Field::NicC, Said::Whole(class.nic_c.into())),
                (Field::SizeCode, Said::Whole(status.lw_codes.into())),
                (
                    Field::AntennaOffset,
                    Said::Whole(status.gps_antenna_offset.into()),
                ),
            ]);
            if let ADSBVersionSurface::DOC9871AppendixC(v2) = &status.version {
                for (field, value) in [
                    (Field::NicA, v2.nic_a),
                    (Field::NacP, v2.nac_p),
                    (Field::Sil, v2.sil),
                    (Field::SurfaceHeading, v2.track_angle_or_heading),
                    (Field::MagneticHeading, v2.horizontal_reference_direction),
                    (Field::SilSupplement, v2.sil_supplement),
                ] {
                    view.insert(field, Said::Whole(value.into()));
                }
            }
            view
        }
        AircraftOperationStatus::Reserved { .. } => View::new(),
    }
}

/// A callsign without spaces; an empty one is none.
pub fn callsign(text: &str) -> Said {
    let text: String = text.chars().filter(|&c| c != ' ').collect();
    if text.is_empty() {
        Said::Nothing
    } else {
        Said::Text(text)
    }
}

fn surface(position: &SurfacePosition) -> View {
    View::from([
        (Field::GroundSpeed, Said::real(position.groundspeed)),
        (Field::Track, Said::real(position.track)),
        (Field::UtcSynchronised, Said::Whole(position.t.into())),
        (Field::CprIsOdd, is_odd(position.parity)),
        (Field::CprLatitude, Said::Whole(position.lat_cpr.into())),
        (Field::CprLongitude, Said::Whole(position.lon_cpr.into())),
    ])
}

fn airborne(position: &AirbornePosition) -> View {
    let is_gnss = position.alt.map(|_| position.source == Source::Gnss);
    View::from([
        (Field::SurveillanceStatus, Said::Whole(position.ss as i64)),
        (Field::Altitude, Said::whole(position.alt)),
        (Field::AltitudeSource, Said::whole(is_gnss)),
        (
            Field::UtcSynchronised,
            Said::Whole(position.time_sync.into()),
        ),
        (Field::CprIsOdd, is_odd(position.parity)),
        (Field::CprLatitude, Said::Whole(position.lat_cpr.into())),
        (Field::CprLongitude, Said::Whole(position.lon_cpr.into())),
    ])
}

fn is_odd(format: CPRFormat) -> Said {
    Said::Whole((format == CPRFormat::Odd).into())
}

fn velocity(velocity: &AirborneVelocity) -> View {
    let is_barometric = velocity
        .vertical_rate
        .map(|_| velocity.vrate_src == VerticalRateSource::BarometricPressureAltitude);
    let mut view = View::from([
        (
            Field::IntentChange,
            Said::Whole(velocity.intent_change.into()),
        ),
        (
            Field::IfrCapable,
            Said::Whole(velocity.ifr_capability.into()),
        ),
        (Field::Nacv, Said::Whole(velocity.nac_v.into())),
        (Field::VerticalRate, Said::whole(velocity.vertical_rate)),
        (Field::VerticalRateIsBarometric, Said::whole(is_barometric)),
        (Field::GnssMinusBaro, Said::whole(velocity.geo_minus_baro)),
    ]);
    let is_true = |kind: &AirspeedType| *kind == AirspeedType::TAS;
    match &velocity.velocity {
        AirborneVelocitySubType::GroundSpeedDecoding(ground) => {
            view.insert(Field::GroundSpeed, Said::Real(ground.groundspeed));
            view.insert(Field::Track, Said::Real(ground.track));
        }
        AirborneVelocitySubType::AirspeedSubsonic(air) => {
            view.insert(Field::Heading, Said::real(air.heading));
            view.insert(Field::Airspeed, Said::whole(air.airspeed));
            let is_true = air.airspeed.map(|_| is_true(&air.airspeed_type));
            view.insert(Field::AirspeedIsTrue, Said::whole(is_true));
        }
        AirborneVelocitySubType::AirspeedSupersonic(air) => {
            view.insert(Field::Heading, Said::real(air.heading.map(f64::from)));
            view.insert(Field::Airspeed, Said::whole(air.airspeed));
            let is_true = air.airspeed.map(|_| is_true(&air.airspeed_type));
            view.insert(Field::AirspeedIsTrue, Said::whole(is_true));
        }
        AirborneVelocitySubType::Reserved0(_) | AirborneVelocitySubType::Reserved1(_) => {}
    }
    view
}
