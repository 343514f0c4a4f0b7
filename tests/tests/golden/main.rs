//! Golden: what this project reads in two recorded logs, against two decoders that others wrote.
//!
//! ```text
//!   log (388 038 frames) ─┬─► mode-s ───────► fields ─┐
//!                         ├─► rs1090 0.7 ───► fields ─┼─► compared, field by field ─► agreed | accepted (a line) | unexplained
//!                         └─► adsb_deku 0.8 ► fields ─┘
//!   pairs of positions ─────► cpr::global, cpr::local against the peers' own CPR
//!   times and frames ───────► tracker against rs1090's fields and its own tracking of places
//!   all places shown ───────► judged by hindsight: the whole track before and after each (`tracks`)
//!   Comm-B replies ─────────► the registers found, against rs1090's decoders of them
//! ```
//! A difference is accepted only by a line in `accepted.rs`, with its reason and its exact count; any other one fails, and so does a
//! count that moved. What it is not: it tells nothing of reception (both logs hold bytes) and nothing of fields that neither peer
//! reads (NIC, on ground of DF11). rs1090 began as a fork of adsb_deku: a reading that both inherited counts as one opinion.

mod accepted;
mod commb;
mod height;
mod ledger;
mod ours;
mod peer_adsb_deku;
mod peer_rs1090;
mod places;
mod tracked;
mod tracks;
mod view;

use accepted::ACCEPTED;
use ledger::{Difference, Ledger, Peer, Subject, is_same};
use mode_s::{Frame, Message, Parity};
use tests::logs::{Heard, Log};
use view::{Field, Said, View};

/// Fields that are compared even where our parity check refuses the frame.
const WITHOUT_PARITY: [Field; 2] = [Field::Df, Field::Residual];

/// Compares the fields of one frame with those of one peer.
fn compare_fields(
    ledger: &mut Ledger,
    peer: Peer,
    frame: &Frame,
    ours: &View,
    theirs: Option<View>,
) {
    let taken_here = Parity::of(frame) != Parity::Broken;
    let mut note = |subject, is_same, ours, theirs| {
        ledger.compare(
            is_same,
            Difference {
                peer,
                subject,
                ours,
                theirs,
                frame,
            },
        );
    };
    let taken = |taken: bool| Said::Whole(taken.into());
    // adsb_deku leaves the parity to its caller, so only its refusals say something.
    if peer == Peer::Rs1090 || theirs.is_none() {
        let there = theirs.is_some();
        note(
            Subject::Taken,
            taken_here == there,
            taken(taken_here),
            taken(there),
        );
    }
    for (field, theirs) in theirs.into_iter().flatten() {
        if taken_here || WITHOUT_PARITY.contains(&field) {
            let ours = ours.get(&field).cloned().unwrap_or(Said::Nothing);
            note(
                Subject::Of(field),
                is_same(field, &ours, &theirs),
                ours,
                theirs,
            );
        }
    }
}

fn compare_log(log: Log, compared: [(Peer, u32); 2]) {
    let frames = log.read();
    let mut ledger = Ledger::new(log, ACCEPTED);
    let mut places = places::Pairs::default();
    let mut tracked = tracked::Tracked::new();
    let mut comm_b = commb::CommB::new();
    for Heard { at_ms, frame } in &frames {
        let ours = ours::view(frame);
        let rs1090 = peer_rs1090::view(frame);
        compare_fields(
            &mut ledger,
            Peer::AdsbDeku,
            frame,
            &ours,
            peer_adsb_deku::view(frame),
        );
        tracked.hear(&mut ledger, *at_ms, frame, rs1090.as_ref());
        compare_fields(&mut ledger, Peer::Rs1090, frame, &ours, rs1090);
        let message = Message::decode(frame);
        places.hear(&mut ledger, frame, &message);
        comm_b.hear(&mut ledger, *at_ms, frame, &message);
    }
    ledger.close(compared);
}

#[test]
fn long_flight_is_read_as_the_peers_read_it() {
    compare_log(
        Log::LongFlight,
        [(Peer::Rs1090, 1_947_873), (Peer::AdsbDeku, 959_775)],
    );
}

#[test]
fn lax_log_is_read_as_the_peers_read_it() {
    compare_log(
        Log::Lax,
        [(Peer::Rs1090, 2_483_254), (Peer::AdsbDeku, 1_431_203)],
    );
}
