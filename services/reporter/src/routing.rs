//! Which encoder makes a message, for what a port carries. Every function gives the message's length, 0 where nothing is to be sent.

use report::{Bits, FrameReport, Full, Moment, Statistics, beast, csbee, raw};
use settings::Settings;
use settings::choices::{BeastTimestamp, Decoded, Raw};
use tracker::Aircraft;

/// A slice that holds any frame as raw protocols tell it.
pub(crate) const MAX_FRAME: usize = if raw::MAX_HEX > beast::MAX_MESSAGE {
    raw::MAX_HEX
} else {
    beast::MAX_MESSAGE
};
/// A slice that holds any aircraft's message.
pub(crate) const MAX_AIRCRAFT: usize = csbee::MAX_LINE;

/// Settings that decide how messages look, not which are sent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    beast: beast::Stamp,
}

impl Look {
    pub(crate) const fn of(settings: &Settings) -> Self {
        Look {
            beast: match settings.beast_timestamp {
                BeastTimestamp::TwelveMhz => beast::Stamp::Count12Mhz,
                BeastTimestamp::Gps => beast::Stamp::Gps,
            },
        }
    }
}

/// A frame.
pub(crate) fn frame(
    protocol: Raw,
    look: &Look,
    report: &FrameReport<'_>,
    out: &mut [u8],
) -> Result<usize, Full> {
    match protocol {
        Raw::None | Raw::Json => Ok(0),
        Raw::Hex => raw::hex(report, out),
        Raw::Hexd => raw::hexd(report, out),
        Raw::Beast => beast::frame(report, look.beast, out),
    }
}

/// Whether Mode A/C replies go out without being asked for: a Beast sends them when its client says so.
pub(crate) const fn mode_ac_unasked(protocol: Raw) -> bool {
    !matches!(protocol, Raw::Beast)
}

/// Whether this is a Mode A/C reply.
pub(crate) const fn is_mode_ac(report: &FrameReport<'_>) -> bool {
    matches!(report.bits, Bits::ModeAc(_))
}

/// An aircraft.
pub(crate) fn aircraft(
    protocol: Decoded,
    _look: &Look,
    aircraft: &Aircraft,
    moment: &Moment,
    out: &mut [u8],
) -> Result<usize, Full> {
    match protocol {
        Decoded::Csbee => csbee::aircraft(aircraft, moment, out),
        _ => Ok(0),
    }
}

/// Statistics that belong to a decoded protocol.
pub(crate) fn own_statistics(
    protocol: Decoded,
    statistics: &Statistics,
    out: &mut [u8],
) -> Result<usize, Full> {
    match protocol {
        Decoded::Csbee => csbee::statistics(statistics, out),
        _ => Ok(0),
    }
}
