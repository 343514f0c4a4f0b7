//! What a decoder reads in one frame, in one form for all decoders.

use std::collections::BTreeMap;

/// A field of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Field {
    Df,
    /// CRC-24 residual of the whole frame.
    Residual,
    /// 24 bits.
    Address,
    /// VS: 1 on the ground.
    VerticalStatus,
    FlightStatus,
    /// CC of DF0.
    CrossLink,
    /// SL.
    SensitivityLevel,
    /// RI.
    ReplyInformation,
    /// DR: 0, 1, 4, 5; the others are one to the peer, so they are 31 here.
    DownlinkRequest,
    /// IIS of UM.
    UtilityInterrogator,
    /// IDS of UM.
    UtilityReservation,
    /// CA of DF11 and DF17; codes 1-3 are one reserved class to the peers, so they are 1 here.
    Capability,
    /// Feet, of any source.
    Altitude,
    /// 0 barometric, 1 GNSS.
    AltitudeSource,
    /// Four octal digits.
    Squawk,
    /// TC, 0-31.
    TypeCode,
    /// Characters, without spaces.
    Callsign,
    /// CA of TC 1-4.
    Category,
    /// Knots.
    GroundSpeed,
    /// Degrees.
    Track,
    /// Degrees.
    Heading,
    /// Knots.
    Airspeed,
    /// 1 true, 0 indicated.
    AirspeedIsTrue,
    /// Feet a minute.
    VerticalRate,
    /// 1 barometric, 0 GNSS.
    VerticalRateIsBarometric,
    /// Feet.
    GnssMinusBaro,
    Nacv,
    /// SS.
    SurveillanceStatus,
    /// T.
    UtcSynchronised,
    /// 1 odd.
    CprIsOdd,
    /// YZ.
    CprLatitude,
    /// XZ.
    CprLongitude,
    /// Of TC 28, subtype 1.
    Emergency,
    /// Feet.
    SelectedAltitude,
    /// 1 FMS, 0 MCP/FCU.
    SelectedByFms,
    /// Hectopascals.
    PressureSetting,
    /// Degrees.
    SelectedHeading,
    NacP,
    NicBaro,
    Sil,
    Autopilot,
    Vnav,
    AltitudeHold,
    Approach,
    TcasOperational,
    Lnav,
    /// Of ADS-B.
    Version,
    NicA,
    NicC,
    Gva,
    SilSupplement,
    /// HRD.
    MagneticHeading,
    EsIn,
    UatIn,
    B2Low,
    SizeCode,
    AntennaOffset,
    /// ARV.
    AirVelocity,
    /// TS.
    TargetStateReport,
    /// TC of the capability class.
    TrajectoryChange,
    /// POA.
    OffsetApplied,
    /// TRK/HDG.
    SurfaceHeading,
    /// IC.
    IntentChange,
    /// IFR.
    IfrCapable,
}

/// What a decoder says of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// The frame has the field, but it holds no value.
    Nothing,
    Whole(i64),
    Real(f64),
    Text(String),
}

impl Said {
    pub fn whole(value: Option<impl Into<i64>>) -> Said {
        value.map_or(Said::Nothing, |value| Said::Whole(value.into()))
    }

    pub fn real(value: Option<f64>) -> Said {
        value.map_or(Said::Nothing, Said::Real)
    }

    /// As a number, where it is one.
    pub fn number(&self) -> Option<f64> {
        match *self {
            Said::Whole(value) => Some(value as f64),
            Said::Real(value) => Some(value),
            Said::Nothing | Said::Text(_) => None,
        }
    }
}

/// The fields a decoder reads in a frame. A field that the decoder does not know of is absent.
pub type View = BTreeMap<Field, Said>;
