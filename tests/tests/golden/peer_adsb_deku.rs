//! What adsb_deku 0.8 reads in a frame. It judges no parity: it gives the residual and leaves the rest to its caller.

use crate::peer_rs1090::callsign;
use crate::view::{Field, Said, View};
use adsb_deku::adsb::{
    AirborneVelocity, AirborneVelocitySubType, AircraftStatusType, ME, OperationStatus,
    StatusForGroundTrack, TargetStateAndStatusInformation, TypeCoding, VerticalRateSource,
};
use adsb_deku::{AC13Field, Altitude, CPRFormat, Capability, DF, Frame as Read, ICAO, Sign};
use mode_s::Frame;

/// The frame as adsb_deku reads it, where it can.
pub fn read(frame: &Frame) -> Option<Read> {
    Read::from_bytes(frame.bytes()).ok()
}

/// The fields; `None` where adsb_deku refuses the frame.
pub fn view(frame: &Frame) -> Option<View> {
    let read = read(frame)?;
    let mut view = View::from([(Field::Residual, Said::Whole(read.crc.into()))]);
    let mut say = |field, said| {
        view.insert(field, said);
    };
    let df = match &read.df {
        DF::ShortAirAirSurveillance { vs, altitude, .. } => {
            say(Field::VerticalStatus, Said::Whole((*vs).into()));
            say(Field::Altitude, ac13(altitude));
            0
        }
        DF::SurveillanceAltitudeReply { fs, ac, .. } => {
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Altitude, ac13(ac));
            4
        }
        DF::SurveillanceIdentityReply { fs, id, .. } => {
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Squawk, Said::Text(format!("{:04x}", id.0)));
            5
        }
        DF::AllCallReply {
            capability, icao, ..
        } => {
            say(Field::Capability, ca(*capability));
            say(Field::Address, address(*icao));
            11
        }
        DF::LongAirAir { vs, altitude, .. } => {
            say(Field::VerticalStatus, Said::Whole((*vs).into()));
            say(Field::Altitude, ac13(altitude));
            16
        }
        DF::ADSB(squitter) => {
            say(Field::Capability, ca(squitter.capability));
            say(Field::Address, address(squitter.icao));
            view.append(&mut me(&squitter.me));
            17
        }
        DF::TisB { cf, .. } => {
            say(Field::Address, address(cf.aa));
            view.append(&mut me(&cf.me));
            18
        }
        DF::ExtendedQuitterMilitaryApplication { .. } => 19,
        DF::CommBAltitudeReply {
            flight_status, alt, ..
        } => {
            say(Field::FlightStatus, Said::Whole(*flight_status as i64));
            say(Field::Altitude, ac13(alt));
            20
        }
        DF::CommBIdentityReply { fs, id, .. } => {
            say(Field::FlightStatus, Said::Whole(*fs as i64));
            say(Field::Squawk, Said::Text(format!("{id:04x}")));
            21
        }
        DF::ModeSExtendedSquitter { .. } => 24,
    };
    view.insert(Field::Df, Said::Whole(df));
    Some(view)
}

/// Its altitude in feet is 0 where there is none.
fn ac13(field: &AC13Field) -> Said {
    Said::whole((field.0 != 0).then_some(field.0))
}

fn address(icao: ICAO) -> Said {
    let [a, b, c] = icao.0;
    Said::Whole(u32::from_be_bytes([0, a, b, c]).into())
}

/// CA with the reserved codes 1-3 as one.
fn ca(capability: Capability) -> Said {
    Said::Whole(match capability {
        Capability::AG_UNCERTAIN => 0,
        Capability::Reserved(_) => 1,
        Capability::AG_GROUND => 4,
        Capability::AG_AIRBORNE => 5,
        Capability::AG_UNCERTAIN2 => 6,
        Capability::AG_UNCERTAIN3 => 7,
    })
}

fn me(me: &ME) -> View {
    let mut view = View::new();
    let type_code = match me {
        ME::NoPosition(_) => 0,
        ME::AircraftIdentification { identification, .. } => {
            view.insert(Field::Category, Said::Whole(identification.ca.into()));
            view.insert(Field::Callsign, callsign(&identification.cn));
            match identification.tc {
                TypeCoding::D => 1,
                TypeCoding::C => 2,
                TypeCoding::B => 3,
                TypeCoding::A => 4,
            }
        }
        ME::SurfacePosition { id, surface } => {
            let has_track = surface.s == StatusForGroundTrack::Valid;
            let track = has_track.then_some(f64::from(surface.trk) * 360.0 / 128.0);
            view.insert(Field::Track, Said::real(track));
            view.insert(Field::UtcSynchronised, Said::Whole(surface.t.into()));
            view.append(&mut cpr(surface.f, surface.lat_cpr, surface.lon_cpr));
            *id
        }
        ME::AirbornePositionBaroAltitude { id, altitude } => {
            view.append(&mut airborne(altitude, false));
            *id
        }
        ME::AirbornePositionGNSSAltitude { id, altitude } => {
            view.append(&mut airborne(altitude, true));
            *id
        }
        ME::AirborneVelocity(inner) => {
            view.append(&mut velocity(inner));
            19
        }
        ME::Reserved0(_) => 23,
        ME::SurfaceSystemStatus(_) => 24,
        ME::Reserved1 { id, .. } => *id,
        ME::AircraftStatus(status) => {
            if status.sub_type == AircraftStatusType::EmergencyPriorityStatus {
                let state = status.emergency_state as i64;
                view.insert(Field::Emergency, Said::Whole(state));
                let squawk = format!("{:04x}", status.squawk);
                view.insert(Field::Squawk, Said::Text(squawk));
            }
            28
        }
        ME::TargetStateAndStatusInformation(state) => {
            if state.subtype == 1 {
                view.append(&mut target(state));
            }
            29
        }
        ME::AircraftOperationalCoordination(_) => 30,
        ME::AircraftOperationStatus(status) => {
            view.append(&mut operational(status));
            31
        }
    };
    view.insert(Field::TypeCode, Said::Whole(type_code.into()));
    view
}

/// It reads the SIL supplement as the source of the altitude, so that is not compared.
fn target(state: &TargetStateAndStatusInformation) -> View {
    let mode = |bit: bool| Said::whole(state.mode_validity.then_some(bit));
    // It gives 0 for "none".
    let feet = (state.altitude != 0).then_some(state.altitude);
    let hectopascals = (state.qnh != 0.0).then_some(f64::from(state.qnh));
    let heading = state.is_heading.then_some(f64::from(state.heading));
    View::from([
        (Field::SelectedAltitude, Said::whole(feet)),
        (Field::PressureSetting, Said::real(hectopascals)),
        (Field::SelectedHeading, Said::real(heading)),
        (Field::NacP, Said::Whole(state.nacp.into())),
        (Field::NicBaro, Said::Whole(state.nicbaro.into())),
        (Field::Sil, Said::Whole(state.sil.into())),
        (Field::Autopilot, mode(state.autopilot)),
        (Field::Vnav, mode(state.vnac)),
        (Field::AltitudeHold, mode(state.alt_hold)),
        (Field::Approach, mode(state.approach)),
        (Field::TcasOperational, Said::Whole(state.tcas.into())),
        (Field::Lnav, mode(state.lnav)),
    ])
}

/// Both logs hold version 2 alone. It keeps the operational modes to itself.
fn operational(status: &OperationStatus) -> View {
    let fields = match status {
        OperationStatus::Airborne(status) => vec![
            (Field::Version, status.version_number as u8),
            (Field::TcasOperational, status.capability_class.acas),
            (Field::EsIn, status.capability_class.cdti),
            (Field::NicA, status.nic_supplement_a),
            (Field::NacP, status.navigational_accuracy_category),
            (Field::Gva, status.geometric_vertical_accuracy),
            (Field::Sil, status.source_integrity_level),
            (Field::NicBaro, status.barometric_altitude_integrity),
            (
                Field::MagneticHeading,
                status.horizontal_reference_direction,
            ),
            (Field::SilSupplement, status.sil_supplement),
        ],
        OperationStatus::Surface(status) => vec![
            (Field::Version, status.version_number as u8),
            (Field::EsIn, status.capability_class.es1090),
            (Field::B2Low, status.capability_class.b2_low),
            (Field::UatIn, status.capability_class.uat_in),
            (Field::Nacv, status.capability_class.nac_v),
            (Field::NicC, status.capability_class.nic_supplement_c),
            (Field::SizeCode, status.lw_codes),
            (Field::AntennaOffset, status.gps_antenna_offset),
            (Field::NicA, status.nic_supplement_a),
            (Field::NacP, status.navigational_accuracy_category),
            (Field::Sil, status.source_integrity_level),
            (
                Field::MagneticHeading,
                status.horizontal_reference_direction,
            ),
            (Field::SilSupplement, status.sil_supplement),
        ],
        OperationStatus::Reserved(..) => Vec::new(),
    };
    let whole = |(field, value): (Field, u8)| (field, Said::Whole(value.into()));
    fields.into_iter().map(whole).collect()
}

fn airborne(position: &Altitude, is_gnss: bool) -> View {
    let mut view = cpr(position.odd_flag, position.lat_cpr, position.lon_cpr);
    view.append(&mut View::from([
        (Field::SurveillanceStatus, Said::Whole(position.ss as i64)),
        (Field::Altitude, Said::whole(position.alt)),
        (
            Field::AltitudeSource,
            Said::whole(position.alt.map(|_| is_gnss)),
        ),
        (Field::UtcSynchronised, Said::Whole(position.t.into())),
    ]));
    view
}

fn cpr(format: CPRFormat, latitude: u32, longitude: u32) -> View {
    let is_odd = format == CPRFormat::Odd;
    View::from([
        (Field::CprIsOdd, Said::Whole(is_odd.into())),
        (Field::CprLatitude, Said::Whole(latitude.into())),
        (Field::CprLongitude, Said::Whole(longitude.into())),
    ])
}

fn velocity(velocity: &AirborneVelocity) -> View {
    let sign = |sign: Sign| i64::from(sign.value());
    let rate = velocity
        .vrate_value
        .checked_sub(1)
        .map(|steps| sign(velocity.vrate_sign) * 64 * i64::from(steps));
    let is_barometric =
        rate.map(|_| velocity.vrate_src == VerticalRateSource::BarometricPressureAltitude);
    // It gives 0 for "none" and for "equal".
    let difference = (velocity.gnss_baro_diff != 0)
        .then(|| sign(velocity.gnss_sign) * i64::from(velocity.gnss_baro_diff));
    let mut view = View::from([
        // Its NACv is IC, IFR and NACv together, five bits.
        (Field::Nacv, Said::Whole((velocity.nac_v & 7).into())),
        (Field::VerticalRate, Said::whole(rate)),
        (Field::VerticalRateIsBarometric, Said::whole(is_barometric)),
        (Field::GnssMinusBaro, Said::whole(difference)),
    ]);
    match &velocity.sub_type {
        AirborneVelocitySubType::GroundSpeedDecoding(_) => {
            // It gives speed and track only beside a vertical rate.
            if let Some((track, speed, _)) = velocity.calculate() {
                view.insert(Field::GroundSpeed, Said::Real(speed));
                view.insert(Field::Track, Said::Real(track.into()));
            }
        }
        AirborneVelocitySubType::AirspeedDecoding(air) => {
            let heading =
                (air.status_heading == 1).then_some(f64::from(air.mag_heading) * 360.0 / 1024.0);
            view.insert(Field::Heading, Said::real(heading));
            // It gives 0 for "none" and for "zero", and knows no supersonic step.
            let knots = (air.airspeed != 0).then_some(air.airspeed);
            view.insert(Field::Airspeed, Said::whole(knots));
            let is_true = knots.map(|_| air.airspeed_type == 1);
            view.insert(Field::AirspeedIsTrue, Said::whole(is_true));
        }
        AirborneVelocitySubType::Reserved0(_) | AirborneVelocitySubType::Reserved1(_) => {}
    }
    view
}
