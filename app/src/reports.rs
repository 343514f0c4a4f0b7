//! What a port reports, and when: frames as they come (BEAST, RAW), or the tracked aircraft once a second (CSBEE).
//!
//! The burst of a second is spread: a few lines a turn of the loop, only while the port has room, so that neither frames nor
//! commands wait for four hundred lines. What a slow port has not taken when the next second begins is dropped and counted.
//!
//! ```text
//!   second begins ─ #S line ─ #A #A #A … as there is room ─┐
//!        ▲             rest of the last burst: dropped      │
//!        └──────────────────────────────────────────────────┘
//! ```

use crate::port::{Outlet, Port};
use demod::RawFrame;
use report::{Bits, FrameReport, FrameTimes, Full, Moment, Statistics, beast, csbee, raw};
use shell::Protocol;
use tracker::Tracker;

/// `#A` lines a turn of the loop: about 0.1 ms of core 0 each.
const LINES_A_TURN: usize = 4;

/// One port's reports.
pub struct Reports {
    protocol: Protocol,
    /// Next aircraft of the burst, and how many it has; `None` between bursts.
    burst: Option<(usize, usize)>,
}

impl Reports {
    /// Reports in this protocol.
    pub const fn new(protocol: Protocol) -> Self {
        Self {
            protocol,
            burst: None,
        }
    }

    /// The protocol in use.
    pub fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// Changes it at once; the rest of a burst is not due any more.
    pub fn set_protocol(&mut self, protocol: Protocol) {
        self.protocol = protocol;
        self.burst = None;
    }

    /// A frame was accepted: its bits as received.
    pub fn frame<O: Outlet>(&mut self, port: &mut Port<O>, raw_frame: &RawFrame) {
        if matches!(self.protocol, Protocol::None | Protocol::Csbee) {
            return;
        }
        let mut out = [0; if raw::MAX_HEX > beast::MAX_MESSAGE {
            raw::MAX_HEX
        } else {
            beast::MAX_MESSAGE
        }];
        let received = raw_frame.received();
        let report = FrameReport {
            bits: Bits::ModeS(&received),
            level_cdbm: raw_frame.level,
            quality_cdb: None,
            times: FrameTimes::at(raw_frame.arrival),
        };
        let made = match self.protocol {
            Protocol::None | Protocol::Csbee => return,
            Protocol::Beast => beast::frame(&report, beast::Stamp::Count12Mhz, &mut out),
            Protocol::Raw => raw::hex(&report, &mut out),
        };
        send(port, &out, made);
    }

    /// A second has ended.
    pub fn second<O: Outlet, const N: usize>(
        &mut self,
        port: &mut Port<O>,
        tracker: &Tracker<N>,
        statistics: &Statistics,
    ) {
        if let Some((next, count)) = self.burst.take() {
            port.dropped_unmade(count.saturating_sub(next) as u32);
        }
        if self.protocol == Protocol::Csbee {
            let mut out = [0; csbee::MAX_LINE];
            let made = csbee::statistics(statistics, &mut out);
            send(port, &out, made);
            self.burst = Some((0, tracker.len()));
        }
    }

    /// Whether a burst is under way.
    pub fn in_burst(&self) -> bool {
        self.burst.is_some()
    }

    /// Goes on with the burst. Returns whether it could go on at once.
    pub fn turn<O: Outlet, const N: usize>(
        &mut self,
        port: &mut Port<O>,
        tracker: &Tracker<N>,
        now_ms: u64,
    ) -> bool {
        let Some((next, count)) = self.burst else {
            return false;
        };
        if next >= count {
            self.burst = None;
            return false;
        }
        if port.outlet.free() < csbee::MAX_LINE {
            return false;
        }
        let mut done = next;
        for aircraft in tracker
            .aircraft()
            .skip(next)
            .take(LINES_A_TURN.min(count - next))
        {
            if port.outlet.free() < csbee::MAX_LINE {
                break;
            }
            let mut out = [0; csbee::MAX_LINE];
            let made = csbee::aircraft(aircraft, &Moment::at(now_ms), &mut out);
            send(port, &out, made);
            done += 1;
        }
        // An aircraft that ended meanwhile leaves fewer than counted: the burst is over.
        self.burst = if done > next {
            Some((done, count))
        } else {
            None
        };
        self.burst.is_some()
    }
}

fn send<O: Outlet>(port: &mut Port<O>, out: &[u8], made: Result<usize, Full>) {
    match made {
        Ok(length) => port.message(&out[..length]),
        Err(Full) => port.dropped_unmade(1),
    }
}
