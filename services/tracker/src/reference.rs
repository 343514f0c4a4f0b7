//! Where the receiver stands, by the kinds of `RX_POSITION`, and what else may serve as a reference.
//!
//! | kind | the receiver stands | surface pairs | places beyond 400 NM |
//! |---|---|---|---|
//! | `None` | nobody says where | the aircraft's own last place, else any aircraft lately shown in the air | shown |
//! | `Fixed` | where the user says | the receiver | refused |
//! | `Gnss` | where its GNSS receiver says | the receiver, once it is known | refused |
//! | `Lowest` | about where the lowest aircraft in the air is shown | that aircraft, else as `None` | shown |
//! | `Icao` | aboard this aircraft | that aircraft, else as `None` | refused, while its place is shown |
//!
//! A surface pair leaves solutions a quarter of the globe apart, so its reference may be wrong by 45°: any place within radio range does.
//! The limit of 400 NM needs the receiver itself: measured from a wrong place it would refuse the right ones.

use mode_s::{Address, Icao, Position};

/// Where the receiver stands.
// Its own discriminant, so that `None` is all zeros and a static tracker costs no flash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum RxPosition {
    /// Nobody says.
    #[default]
    None,
    /// Here, says the user.
    Fixed(Position),
    /// Here, says the GNSS receiver; `None` while it has no fix.
    Gnss(Option<Position>),
    /// About where the lowest aircraft in the air is.
    Lowest,
    /// Aboard the aircraft of this address.
    Icao(Icao),
}

/// How long the place of another aircraft serves as a reference, ms: in ten minutes neither it nor the receiver moves by a part
/// of 45° that matters.
const NEIGHBOUR_LIFE_MS: u64 = 600_000;

/// Places that do not depend on the aircraft at hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct References {
    pub(crate) rx: RxPosition,
    /// The place of the aircraft that `rx` names, as of the last second.
    pub(crate) named: Option<Position>,
    /// The last place shown of any aircraft in the air, and when.
    neighbour: Option<(Position, u64)>,
}

impl References {
    pub(crate) const NONE: References = References {
        rx: RxPosition::None,
        named: None,
        neighbour: None,
    };

    /// Where the receiver stands, near enough to limit what it can hear.
    pub(crate) fn receiver(&self) -> Option<Position> {
        match self.rx {
            RxPosition::None | RxPosition::Lowest => None,
            RxPosition::Fixed(place) => Some(place),
            RxPosition::Gnss(place) => place,
            RxPosition::Icao(_) => self.named,
        }
    }

    /// A place for a surface pair that has none of its own.
    pub(crate) fn somewhere(&self, now_ms: u64) -> Option<Position> {
        let neighbour = self
            .neighbour
            .filter(|&(_, at_ms)| now_ms.wrapping_sub(at_ms) <= NEIGHBOUR_LIFE_MS)
            .map(|(place, _)| place);
        self.receiver().or(self.named).or(neighbour)
    }

    /// An aircraft was shown in the air.
    pub(crate) fn shown_in_the_air(&mut self, place: Position, at_ms: u64) {
        self.neighbour = Some((place, at_ms));
    }

    /// Ends a second: finds the aircraft that `rx` names among `all`.
    pub(crate) fn second_ends(&mut self, all: impl Iterator<Item = Candidate>) {
        self.named = match self.rx {
            RxPosition::Lowest => all
                .filter(|one| one.on_ground == Some(false))
                .filter_map(|one| Some((one.altitude_ft?, one.place?)))
                .min_by_key(|&(altitude, _)| altitude)
                .map(|(_, place)| place),
            RxPosition::Icao(icao) => all
                .filter(|one| one.address == Address::Icao(icao))
                .find_map(|one| one.place),
            RxPosition::None | RxPosition::Fixed(_) | RxPosition::Gnss(_) => None,
        };
    }
}

/// What is asked of an aircraft that may be the one named.
pub(crate) struct Candidate {
    pub(crate) address: Address,
    pub(crate) on_ground: Option<bool>,
    pub(crate) altitude_ft: Option<i32>,
    pub(crate) place: Option<Position>,
}
