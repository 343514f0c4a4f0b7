//! A port: whole messages or nothing, and what became of them.
//!
//! ```text
//!   each kind: offered = sent + dropped
//! ```
//! A message is dropped when it does not fit into the port's buffer or nobody listens: reception never waits for a port. Kinds that may
//! flood a port leave room for those that may not be missed:
//!
//! | kind | leaves free | because |
//! |---|---|---|
//! | frames | 1024 B | a channel at its limit fills any port |
//! | aircraft | all but 2048 B | a slow port always has more of them to send, and what waits grows old |
//! | statistics, GNSS | 0 | a few lines a second |
//! | replies | 0 | somebody waits; where the port has a queue of its own for them they go first |

/// What a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A raw frame.
    Frame,
    /// An aircraft, or what belongs to its protocol.
    Aircraft,
    /// Statistics of either sort, and what a protocol says once a second.
    Statistics,
    /// NMEA or a fix of the GNSS receiver.
    Gnss,
    /// A reply, a log line, the beginning or end of RUN.
    Reply,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 5] = [
        Kind::Frame,
        Kind::Aircraft,
        Kind::Statistics,
        Kind::Gnss,
        Kind::Reply,
    ];

    /// Its name in `AT+STATS?`.
    pub const fn name(self) -> &'static str {
        match self {
            Kind::Frame => "frames",
            Kind::Aircraft => "aircraft",
            Kind::Statistics => "statistics",
            Kind::Gnss => "gnss",
            Kind::Reply => "replies",
        }
    }
}

/// Bytes that frames leave to the rest.
const FRAMES_LEAVE: usize = 1024;
/// Bytes that may wait once an aircraft is added: 0.18 s at 115 200 baud, and enough at 3 Mbaud for the 5 ms that core 0 may sleep.
const AIRCRAFT_WAIT: usize = 2048;

/// Where bytes go.
pub trait Outlet {
    /// Bytes a message may have right now.
    fn free(&self) -> usize;
    /// Bytes that were taken and have not left.
    fn waiting(&self) -> usize;
    /// Sends the whole message, or refuses it whole.
    fn send(&mut self, message: &[u8]) -> bool;
    /// Bytes a reply may have right now.
    fn reply_free(&self) -> usize;
    /// The same for a reply, which goes out before all messages that wait, and never inside one.
    fn reply(&mut self, message: &[u8]) -> bool;
}

/// Messages of a kind since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Due for the port.
    pub offered: u32,
    /// Not taken.
    pub dropped: u32,
}

impl Counts {
    /// Taken whole.
    pub const fn sent(self) -> u32 {
        self.offered.wrapping_sub(self.dropped)
    }
}

/// All that a port counts, 32 bits, wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortCounters {
    kinds: [Counts; Kind::ALL.len()],
    /// Bytes of the messages taken.
    pub bytes: u32,
}

impl PortCounters {
    /// Of one kind.
    pub const fn of(&self, kind: Kind) -> Counts {
        self.kinds[kind as usize]
    }

    /// Of all kinds.
    pub fn total(&self) -> Counts {
        self.kinds
            .iter()
            .fold(Counts::default(), |sum, kind| Counts {
                offered: sum.offered.wrapping_add(kind.offered),
                dropped: sum.dropped.wrapping_add(kind.dropped),
            })
    }
}

/// A port and its counters.
pub struct Port<O> {
    pub outlet: O,
    counters: PortCounters,
}

impl<O: Outlet> Port<O> {
    /// An unused port.
    pub fn new(outlet: O) -> Self {
        Port {
            outlet,
            counters: PortCounters::default(),
        }
    }

    /// What became of the messages so far.
    pub fn counters(&self) -> PortCounters {
        self.counters
    }

    /// Bytes that a message of this kind may have right now.
    pub fn room(&self, kind: Kind) -> usize {
        match kind {
            Kind::Reply => self.outlet.reply_free(),
            Kind::Frame => self.outlet.free().saturating_sub(FRAMES_LEAVE),
            Kind::Aircraft => {
                let more = AIRCRAFT_WAIT.saturating_sub(self.outlet.waiting());
                self.outlet.free().min(more)
            }
            Kind::Statistics | Kind::Gnss => self.outlet.free(),
        }
    }

    /// Sends one whole message or counts it dropped.
    pub fn message(&mut self, kind: Kind, message: &[u8]) {
        let taken = match kind {
            Kind::Reply => self.outlet.reply(message),
            _ => message.len() <= self.room(kind) && self.outlet.send(message),
        };
        let counts = &mut self.counters.kinds[kind as usize];
        counts.offered = counts.offered.wrapping_add(1);
        if taken {
            self.counters.bytes = self.counters.bytes.wrapping_add(message.len() as u32);
        } else {
            counts.dropped = counts.dropped.wrapping_add(1);
        }
    }

    /// Counts messages that were due and could not even be made.
    pub fn dropped_unmade(&mut self, kind: Kind, messages: u32) {
        let counts = &mut self.counters.kinds[kind as usize];
        counts.offered = counts.offered.wrapping_add(messages);
        counts.dropped = counts.dropped.wrapping_add(messages);
    }
}
