//! What this project reads in a frame.

use crate::view::{Field, Said, View};
use mode_s::{
    AltitudeSource, Body, Cpr, CprFormat, Frame, HorizontalVelocity, Me, Message,
    OperationalStatus, Parity, ReplyControl, SelectionSource, TargetState, Velocity,
};

/// What this project reads.
pub fn view(frame: &Frame) -> View {
    let message = Message::decode(frame);
    let mut view = View::new();
    let mut say = |field, said| {
        view.insert(field, said);
    };
    say(Field::Df, Said::Whole(message.df.number().into()));
    say(Field::Residual, Said::Whole(frame.residual().into()));
    if message.parity != Parity::Unjudged {
        let address = message.address().map(|address| address.bits());
        say(Field::Address, Said::whole(address));
    }
    let feet = |altitude: Option<mode_s::AltitudeFt>| Said::whole(altitude.map(|feet| feet.0));
    match message.body {
        Body::AirAir {
            on_ground,
            acas,
            altitude,
            mv,
            ..
        } => {
            if mv.is_none() {
                say(Field::CrossLink, Said::Whole(acas.cross_link.into()));
            }
            let level = acas.sensitivity_level;
            say(Field::SensitivityLevel, Said::Whole(level.into()));
            let information = acas.reply_information;
            say(Field::ReplyInformation, Said::Whole(information.into()));
            say(Field::VerticalStatus, Said::Whole(on_ground.into()));
            say(Field::Altitude, feet(altitude));
        }
        Body::AltitudeReply {
            flight_status,
            control,
            altitude,
            ..
        } => {
            view.append(&mut ours_control(control));
            let mut say = |field, said| {
                view.insert(field, said);
            };
            say(Field::FlightStatus, Said::Whole(flight_status.0.into()));
            say(Field::Altitude, feet(altitude));
        }
        Body::IdentityReply {
            flight_status,
            control,
            squawk,
            ..
        } => {
            view.append(&mut ours_control(control));
            let mut say = |field, said| {
                view.insert(field, said);
            };
            say(Field::FlightStatus, Said::Whole(flight_status.0.into()));
            say(Field::Squawk, Said::Text(format!("{:04o}", squawk.0)));
        }
        Body::AllCallReply { capability } => {
            say(Field::Capability, capability_class(capability.0));
        }
        Body::ExtendedSquitter { origin, me } => {
            if let Some(capability) = origin.capability() {
                say(Field::Capability, capability_class(capability.0));
            }
            view.append(&mut ours_me(&me));
        }
        Body::CoarsePosition(_)
        | Body::Management { .. }
        | Body::Military { .. }
        | Body::CommD(_)
        | Body::NotDecoded => {}
    }
    view
}

fn ours_control(control: ReplyControl) -> View {
    let request = match control.downlink_request {
        known @ (0 | 1 | 4 | 5) => known,
        _ => 31,
    };
    View::from([
        (Field::DownlinkRequest, Said::Whole(request.into())),
        (
            Field::UtilityInterrogator,
            Said::Whole(control.interrogator().into()),
        ),
        (
            Field::UtilityReservation,
            Said::Whole(control.reservation().into()),
        ),
    ])
}

/// CA with the reserved codes 1-3 as one.
fn capability_class(ca: u8) -> Said {
    Said::Whole(match ca {
        1..=3 => 1,
        other => other.into(),
    })
}

fn ours_me(me: &Me) -> View {
    let mut view = View::new();
    let mut say = |field, said| {
        view.insert(field, said);
    };
    match me {
        Me::Identification(id) => {
            say(Field::TypeCode, Said::Whole(id.category.type_code.into()));
            say(Field::Category, Said::Whole(id.category.ca.into()));
            let callsign = id.callsign.map(|callsign| {
                let text = String::from_utf8_lossy(callsign.as_bytes());
                Said::Text(text.replace(' ', ""))
            });
            say(Field::Callsign, callsign.unwrap_or(Said::Nothing));
        }
        Me::SurfacePosition(position) => {
            say(Field::TypeCode, Said::Whole(position.type_code.into()));
            let knots = position.ground_speed_eighths;
            say(
                Field::GroundSpeed,
                Said::real(knots.map(|eighths| f64::from(eighths) / 8.0)),
            );
            say(Field::Track, degrees(position.track));
            say(
                Field::UtcSynchronised,
                Said::Whole(position.utc_synchronised.into()),
            );
            view.append(&mut ours_cpr(position.cpr));
        }
        Me::AirbornePosition(position) => {
            say(Field::TypeCode, Said::Whole(position.type_code.into()));
            say(
                Field::SurveillanceStatus,
                Said::Whole(position.surveillance_status.into()),
            );
            let altitude = position.altitude;
            say(Field::Altitude, Said::whole(altitude.map(|a| a.altitude.0)));
            let is_gnss = altitude.map(|a| a.source == AltitudeSource::Gnss);
            say(Field::AltitudeSource, Said::whole(is_gnss));
            say(
                Field::UtcSynchronised,
                Said::Whole(position.utc_synchronised.into()),
            );
            view.append(&mut ours_cpr(position.cpr));
        }
        Me::Velocity(velocity) => {
            say(Field::TypeCode, Said::Whole(19));
            view.append(&mut ours_velocity(velocity));
        }
        Me::TisbVelocity(told) => {
            say(Field::TypeCode, Said::Whole(19));
            view.append(&mut ours_velocity(&told.velocity));
            view.insert(Field::NacP, Said::Whole(told.nac_p.into()));
            view.insert(Field::Sil, Said::whole(told.sil));
        }
        Me::Emergency(status) => {
            say(Field::TypeCode, Said::Whole(28));
            say(Field::Emergency, Said::Whole(status.state.code().into()));
            let squawk = status.squawk.map(|code| format!("{:04o}", code.0));
            say(Field::Squawk, squawk.map_or(Said::Nothing, Said::Text));
        }
        Me::AcasRa(_) => say(Field::TypeCode, Said::Whole(28)),
        Me::TargetState(state) => {
            say(Field::TypeCode, Said::Whole(29));
            view.append(&mut ours_target(state));
        }
        Me::OperationalStatus(status) => {
            say(Field::TypeCode, Said::Whole(31));
            view.append(&mut ours_operational(status));
        }
        Me::NoPosition(position) => {
            say(Field::TypeCode, Said::Whole(0));
            let feet = position.altitude.map(|feet| feet.0);
            say(Field::Altitude, Said::whole(feet));
        }
        Me::NotDecoded { type_code, .. } => {
            say(Field::TypeCode, Said::Whole((*type_code).into()));
        }
    }
    view
}

fn ours_velocity(velocity: &Velocity) -> View {
    let mut view = View::new();
    let mut say = |field, said| {
        view.insert(field, said);
    };
    say(Field::Nacv, Said::Whole(velocity.nacv.into()));
    say(
        Field::IntentChange,
        Said::Whole(velocity.intent_change.into()),
    );
    say(Field::IfrCapable, Said::Whole(velocity.ifr_capable.into()));
    match velocity.horizontal {
        Some(HorizontalVelocity::Ground { speed_kt, track }) => {
            say(Field::GroundSpeed, Said::Whole(speed_kt.into()));
            say(Field::Track, degrees(track));
        }
        Some(HorizontalVelocity::Air { heading, airspeed }) => {
            say(Field::Heading, degrees(heading));
            say(Field::Airspeed, Said::whole(airspeed.map(|a| a.knots)));
            let is_true = airspeed.map(|a| a.is_true);
            say(Field::AirspeedIsTrue, Said::whole(is_true));
        }
        None => {}
    }
    let rate = velocity.vertical_rate;
    say(
        Field::VerticalRate,
        Said::whole(rate.map(|rate| rate.feet_per_minute)),
    );
    let is_barometric = rate.map(|rate| rate.is_barometric);
    say(Field::VerticalRateIsBarometric, Said::whole(is_barometric));
    say(
        Field::GnssMinusBaro,
        Said::whole(velocity.gnss_minus_baro_ft),
    );
    view
}

fn ours_target(state: &TargetState) -> View {
    let selected = state.selected_altitude;
    let tenths = state.pressure_setting_tenths;
    let modes = state.modes;
    View::from([
        (
            Field::SelectedAltitude,
            Said::whole(selected.map(|selected| selected.altitude.0)),
        ),
        (
            Field::SelectedByFms,
            Said::whole(selected.map(|selected| selected.source == SelectionSource::Fms)),
        ),
        (
            Field::PressureSetting,
            Said::real(tenths.map(|tenths| f64::from(tenths) / 10.0)),
        ),
        (Field::SelectedHeading, degrees(state.selected_heading)),
        (Field::NacP, Said::Whole(state.nac_p.into())),
        (Field::NicBaro, Said::Whole(state.nic_baro.into())),
        (Field::Sil, Said::Whole(state.sil.into())),
        (
            Field::TcasOperational,
            Said::Whole(state.tcas_operational.into()),
        ),
        (Field::Autopilot, Said::whole(modes.map(|m| m.autopilot))),
        (Field::Vnav, Said::whole(modes.map(|m| m.vnav))),
        (
            Field::AltitudeHold,
            Said::whole(modes.map(|m| m.altitude_hold)),
        ),
        (Field::Approach, Said::whole(modes.map(|m| m.approach))),
        (Field::Lnav, Said::whole(modes.map(|m| m.lnav))),
    ])
}

fn ours_operational(status: &OperationalStatus) -> View {
    let size = status.size.map(|size| size.0);
    let offset = status.antenna_offset.map(|offset| offset.0);
    View::from([
        (Field::Version, Said::Whole(status.version.into())),
        (Field::NicA, Said::whole(status.nic_a)),
        (Field::NicC, Said::whole(status.nic_c)),
        (Field::NacP, Said::whole(status.nac_p)),
        (Field::Nacv, Said::whole(status.nac_v)),
        (Field::Gva, Said::whole(status.gva)),
        (Field::Sil, Said::whole(status.sil)),
        (Field::SilSupplement, Said::whole(status.sil_per_sample)),
        (Field::NicBaro, Said::whole(status.nic_baro)),
        (Field::MagneticHeading, Said::whole(status.magnetic_heading)),
        (Field::TcasOperational, Said::whole(status.tcas_operational)),
        (Field::EsIn, Said::whole(status.es_in)),
        (Field::UatIn, Said::whole(status.uat_in)),
        (Field::B2Low, Said::whole(status.b2_low)),
        (Field::SizeCode, Said::whole(size)),
        (Field::AntennaOffset, Said::whole(offset)),
        (Field::AirVelocity, Said::whole(status.air_velocity)),
        (Field::TargetStateReport, Said::whole(status.target_state)),
        (
            Field::TrajectoryChange,
            Said::whole(status.trajectory_change),
        ),
        (Field::OffsetApplied, Said::whole(status.offset_applied)),
        (Field::SurfaceHeading, Said::whole(status.surface_heading)),
    ])
}

fn degrees(angle: Option<mode_s::CentiDegrees>) -> Said {
    Said::real(angle.map(|angle| f64::from(angle.0) / 100.0))
}

fn ours_cpr(cpr: Option<Cpr>) -> View {
    View::from([
        (
            Field::CprIsOdd,
            Said::whole(cpr.map(|cpr| cpr.format == CprFormat::Odd)),
        ),
        (Field::CprLatitude, Said::whole(cpr.map(|cpr| cpr.latitude))),
        (
            Field::CprLongitude,
            Said::whole(cpr.map(|cpr| cpr.longitude)),
        ),
    ])
}
