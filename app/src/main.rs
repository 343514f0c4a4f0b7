//! The firmware image: two cores, the services between them and the ports.
//!
//! ```text
//!   PULSES ─ PIO ─ DMA ─ ring ─▶ core 1: demodulate ─▶ queue ─▶ core 0: decode, track, report ─▶ CONSOLE (USB), COMMS_UART
//! ```
//! Core 1 (`core1`) runs from SRAM with interrupts masked and sleeps between blocks of samples. Core 0 is one loop: frames, seconds,
//! commands, ports; it sleeps when a turn moved nothing. There is no interrupt handler: USB, DMA, the timer's alarm and core 1 only end the
//! sleep.
//!
//! The watchdog is fed by core 0 only after core 1 has taken another block: when either loop stops, the chip restarts within
//! [`WATCHDOG_US`], through the bootloader, which verifies the image again.
//!
//! Settings are loaded before the first frame and acted on (`commands`); the states RUN and CONFIGURATION are `state`'s.
//!
//! How the image ended is kept over the reset and told by `AT+INFO` (`crash`).
#![no_std]
#![no_main]
#![forbid(unsafe_code)]

mod air;
mod clock;
mod commands;
mod confirm;
mod console;
mod core1;
mod crash;
mod hardware;
mod identity;
mod info;
mod load;
mod log;
mod outlets;
mod receiver;
mod self_test;
mod state;
mod station;
mod stats;
mod store;

use air::Air;
use boot_contract::hand_over::{Cause, HandOver};
use clock::Clock;
use confirm::{Confirm, Due};
use console::Inputs;
use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, Ordering};
use core1::{Context, QUEUE_SLOTS, QueueCounters, REPLY_SLOTS};
use crash::Crash;
use demod::{
    ArrivalRing, Calibration, Counters, Demodulator, LevelRing, RawFrame, Reply, ReplyLevels,
    Rings, SampleRing,
};
use drivers::led::Led;
use drivers::pulse_capture::{CaptureCounters, PulseCapture};
use drivers::trigger_level::{self, TriggerLevel};
use hal::kept::{End, LastWords};
use hal::parts::TRIGGER_LEVEL_PERIOD;
use hal::take_once::TakeOnce;
use hal::{Parts, sleep, stack, timer, watchdog};
use hardware::Hardware;
use heapless::spsc::Queue;
use load::Load;
use receiver::{AIRCRAFT, Receiver, Shared};
use report::{FrameTimes, Gnss};
use reporter::Reporter;
use settings::Stored;
use state::States;
use station::Station;
use stats::DecodeCounters;
use store::SettingsStore;
use tracker::Tracker;

/// Without a check-in of both loops for this long the chip restarts, microseconds.
const WATCHDOG_US: u32 = 3_000_000;
/// Core 0 wakes at least this often: LED, a rate change, the watchdog. Microseconds.
const BEAT_US: u64 = 50_000;
/// Core 0 looks for what COMMS_UART received at least this often, microseconds: DMA takes the characters, and nothing tells of them. A
/// command is answered within 10 ms.
const LOOK_US: u64 = 5_000;
const _: () = assert!(TRIGGER_LEVEL_PERIOD == trigger_level::PERIOD);

static RING: SampleRing = SampleRing::new();
static ARRIVAL_RING: ArrivalRing = ArrivalRing::new();
static LEVEL_RING: LevelRing = LevelRing::new();
static QUEUE: TakeOnce<Queue<RawFrame, QUEUE_SLOTS>> = TakeOnce::new(Queue::new());
static REPLIES: TakeOnce<Queue<Reply, REPLY_SLOTS>> = TakeOnce::new(Queue::new());
static CORE1: TakeOnce<Option<Context>> = TakeOnce::new(None);
static TRACKER: TakeOnce<Tracker<AIRCRAFT>> = TakeOnce::new(Tracker::new());
/// The noise at the antenna, 1/100 dBm: core 0 measures, core 1 uses it.
static FLOOR_CDBM: AtomicI32 = AtomicI32::new(Calibration::ADSBEE_1090.floor_cdbm as i32);
static SHARED: Shared = Shared {
    is_receiving: AtomicBool::new(false),
    wants_refused: AtomicBool::new(false),
    wants_replies: AtomicBool::new(false),
    capture: CaptureCounters::new(),
    demod: Counters::new(),
    queue: QueueCounters::new(),
    core1_idle_us: AtomicU32::new(0),
    unheard_words: AtomicU32::new(0),
};

#[hal::entry]
fn main() -> ! {
    match start() {
        Some(never) => match never {},
        // Only a mistake of placement or of clocks leads here: there is no port to say it on.
        None => watchdog::reset(HandOver::Restart(Cause::Other).words()),
    }
}

/// Brings everything up and runs; `None` when something did not come up.
fn start() -> Option<core::convert::Infallible> {
    let cause = match HandOver::from_words(watchdog::hand_over_words()) {
        Some(HandOver::Report(cause)) => Some(cause),
        _ => None,
    };
    watchdog::set_hand_over_words([0, 0]);

    let mut parts = Parts::take()?;
    parts.watchdog.start(WATCHDOG_US);
    stack::mark_core0();
    let mut led = Led::new(parts.led);
    let mut hardware = Hardware::new(
        parts.bias_tee,
        parts.esp32_enable,
        parts.trigger_level_low,
        parts.boot_config,
    );
    let mut store = SettingsStore::new(parts.i2c, parts.settings_flash);
    let loaded = commands::load(&mut store);
    let settings_trouble = loaded.err();
    // A PWM that cannot be set is not a thing on this chip: the error type is empty.
    let trigger_level = TriggerLevel::new(parts.trigger_level).ok()?;
    let console = parts.usb.attach()?;

    let stored = loaded.unwrap_or(Stored::FACTORY);
    // Before the sampler, with which the pulse's counters start.
    let gnss_baud = stored.settings.gnss_baud;
    let gnss = parts.gnss.map(|gnss| gnss.start(gnss_baud));
    let (producer, consumer) = QUEUE.take()?.split();
    let (replies_producer, replies) = REPLIES.take()?.split();
    let capture_start_us = timer::now_us();
    let capture = PulseCapture::start(
        parts.sampler,
        &mut parts.converter,
        parts.dma,
        &RING.words,
        &ARRIVAL_RING.words,
        &LEVEL_RING.words,
        &SHARED.capture,
    )
    .ok()?;
    let context = CORE1.take()?;
    *context = Some(Context {
        capture,
        rings: Rings {
            samples: &RING,
            arrival: &ARRIVAL_RING,
            level: &LEVEL_RING,
        },
        demodulator: Demodulator::new(Calibration::ADSBEE_1090),
        demod_counters: &SHARED.demod,
        floor_cdbm: &FLOOR_CDBM,
        is_receiving: &SHARED.is_receiving,
        unheard_words: &SHARED.unheard_words,
        wants_refused: &SHARED.wants_refused,
        wants_replies: &SHARED.wants_replies,
        queue: producer,
        replies: replies_producer,
        queue_counters: &SHARED.queue,
        idle_us: &SHARED.core1_idle_us,
    });
    let mut wakes = parts.core1.launch(context, core1::run);

    let mut air = Air::new(parts.converter, trigger_level, &RING, &LEVEL_RING);
    air.follow(&stored.settings);
    let confirm = Confirm::new(parts.flash);
    let is_held = hardware.is_config_held();
    let mut receiver = Receiver {
        console: Reporter::new(settings::Port::Console, outlets::Console(console)),
        comms: Reporter::new(settings::Port::CommsUart, outlets::Comms(parts.comms_uart)),
        station: Station {
            unique_id: u64::from_be_bytes(parts.unique_id),
            gnss: Gnss::default(),
            second_began: FrameTimes::at(0),
        },
        load: Load::new(&SHARED.core1_idle_us),
        clock: Clock::new(
            gnss,
            gnss_baud,
            capture_start_us,
            &SHARED.capture.fifo_overflows,
        ),
        queue: consumer,
        replies,
        reply_levels: ReplyLevels::new(Calibration::ADSBEE_1090),
        level_ring: &LEVEL_RING,
        tracker: TRACKER.take()?,
        shared: &SHARED,
        decode: DecodeCounters::default(),
        commands: 0,
        comms_received: 0,
        capture_start_us,
        start: cause,
        second: 0,
        second_ends_us: 1_000_000,
        is_ending_second: false,
        last: (0, 0, 0),
        leave: None,
        states: States::new(settings_trouble.is_some(), is_held),
        version: identity::version(&confirm),
        board: identity::board(&confirm),
        serial: identity::serial(parts.unique_id),
        confirm,
        crash: Crash::at_start(cause),
        is_usb_drive_allowed: false,
        told: log::Told::default(),
        store,
        settings_trouble,
        hardware,
        stored,
        air,
    };
    receiver.act_on_all();
    let mut input = Inputs::new();
    let mut next_beat_us = timer::now_us() + BEAT_US;
    // Before the first beat too an end shall be told.
    receiver.life(0).keep();
    let (mut blocks_seen, mut block_seen_us) = (0, timer::now_us());

    loop {
        wakes.drain();
        timer::acknowledge_alarm();
        let more_frames = receiver.frames(|| led.frame());
        // Frames go first: replies are taken while no frame waits.
        let more_replies = !more_frames && receiver.replies();
        let more_reports = receiver.reports();
        let more_bytes = receiver.commands(&mut input) | receiver.listen();
        SHARED
            .is_receiving
            .store(receiver.is_receiving(), Ordering::Relaxed);
        receiver.leave_if_due();
        if receiver.confirm.serve(receiver.now_ms()) == Due::GiveUp {
            LastWords::new(End::GaveUp).say();
            watchdog::reset(HandOver::Restart(Cause::Other).words());
        }

        let now_us = timer::now_us();
        if now_us >= next_beat_us {
            receiver.see_pin();
            led.mark(receiver.marks());
            if let Some(floor_cdbm) = receiver.look() {
                FLOOR_CDBM.store(i32::from(floor_cdbm), Ordering::Relaxed);
            }
            SHARED
                .wants_refused
                .store(receiver.wants_refused(), Ordering::Relaxed);
            SHARED
                .wants_replies
                .store(receiver.wants_replies(), Ordering::Relaxed);
            led.beat(receiver.shows());
            next_beat_us = next_beat(now_us, capture_start_us);
            let stalled_ms = (now_us - block_seen_us) / 1000;
            receiver.life(stalled_ms as u32).keep();
        }
        let blocks = SHARED.capture.blocks.load(Ordering::Relaxed);
        if blocks != blocks_seen {
            (blocks_seen, block_seen_us) = (blocks, now_us);
            parts.watchdog.feed();
        }
        if !(more_frames || more_replies || more_reports || more_bytes) {
            let look_us = next_beat_us.min(now_us + LOOK_US);
            timer::set_alarm(look_us);
            sleep::unless(|| {
                receiver.queue.ready()
                    || receiver.replies.ready()
                    || receiver.comms.port.outlet.0.has_received()
                    || timer::now_us() >= look_us
            });
            receiver.load.slept(timer::now_us() - now_us);
        }
    }
}

/// The next beat: on a multiple of [`BEAT_US`] of uptime, so that the seconds begin on time.
fn next_beat(now_us: u64, capture_start_us: u64) -> u64 {
    let uptime_us = now_us - capture_start_us;
    capture_start_us + (uptime_us / BEAT_US + 1) * BEAT_US
}

/// Keeps where it happened, and resets through the watchdog; the next start tells both.
#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    crash::panicked(info);
    watchdog::reset(HandOver::Restart(Cause::Panic).words())
}
