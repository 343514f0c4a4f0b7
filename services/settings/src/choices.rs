//! The enumerations. Numbers as ruled: 003's and 004's where they print them, ours in their order elsewhere.

use crate::choice::{Choice, choices};

choices! {
    /// Reports of decoded aircraft on a port (`ADSB_RX_PROTOCOL_DECODED`).
    Decoded:
    /// No reports.
    None = 0 "NONE" []
    /// Aerobits' text, `#A` with 16 fields.
    Csv = 1 "CSV" ["AERO"]
    /// MAVLink with version 1 framing.
    Mavlink1 = 2 "MAVLINK1" ["MAVLINK"]
    /// The `adsb` section as JSON.
    Json = 3 "JSON" []
    /// GDL90.
    Gdl90 = 4 "GDL90" []
    /// ASTERIX categories 021 and 023.
    Asterix = 5 "ASTERIX" []
    /// ADSBee's text, `#A` with 18 fields.
    Csbee = 100 "CSBEE" []
    /// MAVLink with version 2 framing.
    Mavlink2 = 101 "MAVLINK2" []
    /// The JSON sections that `AERO_JSON_BITMASK` picks (`PROTOCOL=8`).
    AeroJson = 102 "AERO_JSON" []
}

choices! {
    /// Raw frames on a port (`ADSB_RX_PROTOCOL_RAW`).
    Raw:
    /// No frames.
    None = 0 "NONE" []
    /// `*hex;(SIGS,SIGQ,TS1s,TS24h)`.
    Hex = 1 "HEX" ["RAW"]
    /// Mode S Beast.
    Beast = 2 "BEAST" []
    /// The `raw` section as JSON.
    Json = 3 "JSON" []
    /// `*hex;`, for dump1090.
    Hexd = 4 "HEXD" ["DUMP1090"]
}

choices! {
    /// What a port carries, said in one word (`PROTOCOL`): a view of [`Decoded`] and [`Raw`].
    Protocol:
    /// Nothing.
    None = 0 "NONE" []
    /// Raw frames as text with reception data.
    Raw = 1 "RAW" ["HEX"]
    /// Aerobits' text.
    Csv = 2 "CSV" ["AERO"]
    /// MAVLink 1.
    Mavlink1 = 3 "MAVLINK1" ["MAVLINK"]
    /// ASTERIX.
    Asterix = 4 "ASTERIX" []
    /// GDL90.
    Gdl90 = 5 "GDL90" []
    /// Mode S Beast.
    Beast = 7 "BEAST" []
    /// The JSON sections that `AERO_JSON_BITMASK` picks.
    Json = 8 "JSON" []
    /// ADSBee's text.
    Csbee = 100 "CSBEE" []
    /// MAVLink 2.
    Mavlink2 = 101 "MAVLINK2" []
    /// Raw frames as dump1090 reads them.
    Hexd = 102 "HEXD" ["DUMP1090"]
    /// Read only: what no single word says, see `ADSB_RX_PROTOCOL_DECODED` and `_RAW`.
    Mixed = 103 "MIXED" []
}

choices! {
    /// Statistics of reception on a port (`ADSB_STATISTICS`).
    AdsbStatistics:
    /// No statistics.
    None = 0 "NONE" []
    /// `#AS:FPSS,FPSAC,CALIB`.
    Csv = 1 "CSV" []
    /// As JSON.
    Json = 2 "JSON" []
    /// 004's `#S:CPU,RES,RES,FPSS,FPSAC,TSCAL`.
    CsvSf1 = 3 "CSV_SF1" []
}

choices! {
    /// Statistics of the device on a port (`SYSTEM_STATISTICS`).
    SystemStatistics:
    /// No statistics.
    None = 0 "NONE" []
    /// `#S:CPL,UPT`.
    Csv = 1 "CSV" []
    /// As JSON.
    Json = 2 "JSON" []
}

choices! {
    /// NMEA sentences of the GNSS receiver on a port, as `GNSS_LOG` counts them.
    Nmea:
    /// None.
    None = 0 "NONE" []
    /// RMC alone.
    Rmc = 1 "RMC" []
    /// All.
    All = 2 "ALL" []
}

choices! {
    /// The same, as `GNSS_RX_PROTOCOL_RAW` numbers it.
    GnssRaw:
    /// None.
    None = 0 "NONE" []
    /// Forwarded.
    Nmea = 5 "NMEA" []
}

choices! {
    /// The GNSS receiver's fix on a port (`GNSS_RX_PROTOCOL_DECODED`).
    GnssDecoded:
    /// Not.
    None = 0 "NONE" []
    /// The `gnss` section as JSON.
    Json = 3 "JSON" []
}

choices! {
    /// Who sets up the GNSS receiver (`GNSS_CONFIG`).
    GnssConfig:
    /// Its owner: nothing is sent to it.
    Off = 0 "OFF" []
    /// The device, which takes it for a u-blox.
    Ublox = 1 "UBLOX" []
}

choices! {
    /// When decoded aircraft are reported (`ADSB_RX_PROTOCOL_INC`).
    Reporting:
    /// All once a second.
    EverySecond = 0 "ALWAYS" []
    /// Once a second each, when updated, spread over the second.
    Updated = 1 "UPDATED" []
    /// When a position has changed.
    Position = 2 "POSITION" []
}

choices! {
    /// Which altitude GDL90 and MAVLink prefer (`SUBPROTOCOL`).
    AltitudeOrder:
    /// Geometric first.
    GeometricFirst = 0 "GEOMETRIC" []
    /// Barometric first.
    BarometricFirst = 1 "BAROMETRIC" []
}

choices! {
    /// Names of the JSON fields (`JSON_PROFILE`).
    JsonProfile:
    /// 003's.
    Tt = 0 "TT_SG1" []
    /// 004's.
    Sf1 = 1 "TT_SF1" []
}

choices! {
    /// Which demodulated frames raw outputs carry (`RAW_FILTER`).
    RawFilter:
    /// Every one.
    All = 0 "ALL" []
    /// Accepted ones.
    Accepted = 1 "ACCEPTED" []
}

choices! {
    /// Stamps of Beast frames (`BEAST_TIMESTAMP`).
    BeastTimestamp:
    /// A count at 12 MHz that never restarts.
    TwelveMhz = 0 "12MHZ" []
    /// Time of day as the Radarcape sends it.
    Gps = 1 "GPS" []
}

choices! {
    /// What is logged on CONSOLE (`LOG_LEVEL`).
    LogLevel:
    /// Nothing.
    Silent = 0 "SILENT" []
    /// Errors.
    Errors = 1 "ERRORS" []
    /// Warnings and errors.
    Warnings = 2 "WARNINGS" []
    /// Everything.
    Info = 3 "INFO" ["LOGS"]
}

choices! {
    /// Who says where the receiver stands (`RX_POSITION`).
    RxSource:
    /// Nobody.
    None = 0 "NONE" []
    /// The user.
    Fixed = 1 "FIXED" []
    /// The GNSS receiver.
    Gnss = 2 "GNSS" []
    /// The lowest aircraft in the air.
    Lowest = 3 "LOWEST" []
    /// The aircraft of an address.
    Icao = 4 "ICAO" []
}

choices! {
    /// Whether the trigger level is steered (`TL_SET=LEARN`).
    TriggerMode:
    /// As set.
    Set = 0 "SET" []
    /// Steered by the noise.
    Learn = 1 "LEARN" []
}
