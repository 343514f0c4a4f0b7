//! Values as replies write them.

use crate::command::MASK;
use crate::device::Device;
use crate::dialect::Dialect;
use crate::state::State;
use core::fmt;
use settings::choices::RxSource;
use settings::{Entry, Field, INDEXED_BAUDS, Info, Port, Scope, Settings, Value, What};

/// Where a line arrived, and in which state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The port.
    pub port: Port,
    /// The state.
    pub state: State,
}

impl Place {
    /// The dialect of the state.
    pub const fn dialect(&self) -> Dialect {
        match self.state {
            State::Run => Dialect::Adsbee,
            State::Configuration { .. } => Dialect::Aerobits,
        }
    }
}

/// The value of an entry, behind the `=`.
pub(crate) struct Shown<'a, D: Device> {
    pub entry: &'a Entry,
    pub device: &'a D,
    pub place: Place,
    pub dialect: Dialect,
}

impl<D: Device> fmt::Display for Shown<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.entry.what {
            What::Setting { secret: true, .. } => f.write_str(MASK),
            What::Setting { fields, scope, .. } => self.setting(f, fields, scope),
            What::Value { info, .. } => self.value(f, info),
            What::Command { .. } => Ok(()),
        }
    }
}

impl<D: Device> Shown<'_, D> {
    fn setting(&self, f: &mut fmt::Formatter<'_>, fields: &[Field], scope: Scope) -> fmt::Result {
        let settings = self.device.settings();
        match scope {
            Scope::Device | Scope::Echoed | Scope::Port => {
                list(f, settings, self.place.port, self.dialect, fields)
            }
            Scope::TriggerLevel => list(
                f,
                settings,
                self.place.port,
                self.dialect,
                &[Field::TlLo, Field::TlHi],
            ),
            Scope::BaudRate => {
                let baud = settings.comms_baud;
                match INDEXED_BAUDS.iter().position(|rate| *rate == baud) {
                    Some(index) => write!(f, "{index}"),
                    None => write!(f, "{baud}"),
                }
            }
            Scope::Position => position(f, settings),
            Scope::SerialNumber => f.write_str(self.device.identity().serial),
        }
    }

    fn value(&self, f: &mut fmt::Formatter<'_>, info: Info) -> fmt::Result {
        let identity = self.device.identity();
        match (info, self.place.state) {
            (Info::Boot, _) => f.write_str("0"),
            (Info::Config, State::Run) => f.write_str("0"),
            (Info::Config, State::Configuration { as_set, .. }) => {
                f.write_str(if as_set { "2" } else { "1" })
            }
            (Info::Lock, State::Configuration { locked: true, .. }) => f.write_str("1"),
            (Info::Lock, _) => f.write_str("0"),
            (Info::Device, _) => f.write_str(identity.device),
            (Info::FirmwareVersion, _) => f.write_str(identity.version),
            (Info::Uptime, _) => write!(f, "{}", self.device.uptime_s()),
        }
    }
}

/// Fields, split by commas.
pub(crate) fn list(
    f: &mut fmt::Formatter<'_>,
    settings: &Settings,
    port: Port,
    dialect: Dialect,
    fields: &[Field],
) -> fmt::Result {
    for (index, field) in fields.iter().enumerate() {
        if index > 0 {
            f.write_str(",")?;
        }
        let value: Value = field.get(settings, port);
        field.kind().write(f, value, dialect.by_name())?;
    }
    Ok(())
}

/// `RX_POSITION`'s arguments: those that its first one needs.
fn position(f: &mut fmt::Formatter<'_>, settings: &Settings) -> fmt::Result {
    let fields: &[Field] = match settings.rx_source {
        RxSource::None | RxSource::Gnss | RxSource::Lowest => &[Field::RxSource],
        RxSource::Fixed => &[Field::RxSource, Field::RxLat, Field::RxLon, Field::RxHeight],
        RxSource::Icao => &[Field::RxSource, Field::RxIcao],
    };
    list(f, settings, Port::Console, Dialect::Adsbee, fields)
}
