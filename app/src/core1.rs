//! Core 1: from blocks of samples to frames in the queue. Nothing else, for ever, from SRAM alone.
//!
//! ```text
//!   wait (WFI) for 32 words ─▶ demodulate up to the newest word ─┬▶ queue of 127 frames ──────▶ wake core 0 if any
//!     128 us                     the budget: 15 360 cycles a block └▶ queue of 31 replies, if a port asks
//!                                                                     full: dropped, counted
//!                                while nobody receives: passed over, counted
//! ```
//! Everything here, and all it calls, is placed in SRAM by `linker/app.x`; interrupts stay masked.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, Ordering};
use demod::{Counters, Demodulator, RING_WORDS, RawFrame, Reply, Rings};
use drivers::pulse_capture::PulseCapture;
use heapless::spsc::Producer;

/// Slots of the frame queue; it holds one frame less. 127 frames are 15 ms of back-to-back long frames.
pub const QUEUE_SLOTS: usize = 128;

/// Slots of the queue of Mode A/C replies; it holds one reply less: 0.8 ms at 40 000 a second. A queue of its own, so that they never take a frame's place.
pub const REPLY_SLOTS: usize = 32;

/// Refused frames enter the queue while fewer frames than this wait: the rest is kept for accepted ones.
const REFUSED_WAITING: usize = QUEUE_SLOTS / 4;

/// What became of frames at the queue: `offered = queued + dropped`, of accepted ones alone.
pub struct QueueCounters {
    /// Frames the demodulator accepted.
    pub offered: AtomicU32,
    /// Frames handed to core 0.
    pub queued: AtomicU32,
    /// Frames lost because core 0 was late.
    pub dropped: AtomicU32,
    /// Refused frames handed to core 0.
    pub refused_queued: AtomicU32,
    /// Refused frames for which there was no room.
    pub refused_dropped: AtomicU32,
    /// Mode A/C replies handed to core 0, while a port asks.
    pub replies_queued: AtomicU32,
    /// Mode A/C replies for which there was no room, while a port asks.
    pub replies_dropped: AtomicU32,
}

impl QueueCounters {
    /// All zero.
    pub const fn new() -> Self {
        Self {
            offered: AtomicU32::new(0),
            queued: AtomicU32::new(0),
            dropped: AtomicU32::new(0),
            refused_queued: AtomicU32::new(0),
            refused_dropped: AtomicU32::new(0),
            replies_queued: AtomicU32::new(0),
            replies_dropped: AtomicU32::new(0),
        }
    }
}

/// What core 1 owns.
pub struct Context {
    pub capture: PulseCapture<RING_WORDS>,
    pub rings: Rings<'static>,
    pub demodulator: Demodulator,
    pub demod_counters: &'static Counters,
    /// The noise at the antenna as core 0 measures it, 1/100 dBm.
    pub floor_cdbm: &'static AtomicI32,
    /// Whether there is anybody to receive for: not in CONFIGURATION, nor with `RX_ENABLE=0`.
    pub is_receiving: &'static AtomicBool,
    /// Words that were sampled meanwhile and not looked at. The sampler never stops, because stamps count its samples.
    pub unheard_words: &'static AtomicU32,
    /// Whether core 0 wants refused frames, too.
    pub wants_refused: &'static AtomicBool,
    /// Whether core 0 wants Mode A/C replies.
    pub wants_replies: &'static AtomicBool,
    pub queue: Producer<'static, RawFrame>,
    pub replies: Producer<'static, Reply>,
    pub queue_counters: &'static QueueCounters,
    /// Microseconds this core slept.
    pub idle_us: &'static AtomicU32,
}

/// Core 1's loop.
pub fn run(slot: &'static mut Option<Context>) -> ! {
    let Some(context) = slot else {
        // Core 0 fills the slot before it starts this core. Without it no block is ever counted, and the watchdog ends this.
        loop {
            hal::core1::idle();
        }
    };
    context.capture.attach();
    loop {
        block(context);
    }
}

/// One block of samples.
fn block(context: &mut Context) {
    let asleep_from_us = hal::timer::now_us_low();
    let written = context.capture.wait();
    let slept_us = hal::timer::now_us_low().wrapping_sub(asleep_from_us);
    add(context.idle_us, slept_us);
    let Context {
        capture,
        rings,
        demodulator,
        demod_counters,
        floor_cdbm,
        is_receiving,
        unheard_words,
        wants_refused,
        wants_replies,
        queue,
        replies,
        queue_counters,
        ..
    } = context;
    if !is_receiving.load(Ordering::Relaxed) {
        add(unheard_words, demodulator.pass_over(written));
        return;
    }
    demodulator.set_floor(floor_cdbm.load(Ordering::Relaxed) as i16);
    demodulator.tell_refused(wants_refused.load(Ordering::Relaxed));
    demodulator.tell_replies(wants_replies.load(Ordering::Relaxed));
    let mut heard = false;
    let mut replied = false;
    let mut newest = || capture.written();
    let mut frame = |frame: RawFrame| {
        heard = true;
        let counters = &**queue_counters;
        let (queued, dropped, has_room) = if frame.is_accepted() {
            count(&counters.offered);
            (&counters.queued, &counters.dropped, true)
        } else {
            let has_room = queue.len() < REFUSED_WAITING;
            (
                &counters.refused_queued,
                &counters.refused_dropped,
                has_room,
            )
        };
        if has_room && queue.enqueue(frame).is_ok() {
            count(queued);
        } else {
            count(dropped);
        }
    };
    let mut reply = |reply| {
        replied = true;
        count(match replies.enqueue(reply) {
            Ok(()) => &queue_counters.replies_queued,
            Err(_) => &queue_counters.replies_dropped,
        });
    };
    demodulator.run(
        *rings,
        written,
        demod_counters,
        &mut newest,
        &mut frame,
        &mut reply,
    );
    if heard || replied {
        hal::core1::wake_core0();
    }
}

#[inline(always)]
fn count(counter: &AtomicU32) {
    add(counter, 1);
}

/// One writer: a load and a store do.
#[inline(always)]
fn add(counter: &AtomicU32, count: u32) {
    let sum = counter.load(Ordering::Relaxed).wrapping_add(count);
    counter.store(sum, Ordering::Relaxed);
}
