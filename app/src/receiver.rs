//! Core 0's work: frames from the queue to tracker and reports, a second's turn, commands.
//!
//! ```text
//!   queue ─ Message ─┬─ tracker
//!                    ├─ CONSOLE reports ─▶ port
//!                    └─ COMMS_UART reports ─▶ port
//!   second ─ tracker's turn, in slices ─ #S and bursts
//! ```
//! Time here is milliseconds of uptime, counted from the first sample, which is the zero of the frames' ticks too.

use crate::air::Air;
use crate::clock::Clock;
use crate::confirm::Confirm;
use crate::console::Inputs;
use crate::core1::QueueCounters;
use crate::crash::{Crash, Life};
use crate::hardware::Hardware;
use crate::load::Load;
use crate::log::Told;
use crate::outlets;
use crate::state::States;
use crate::station::Station;
use crate::stats::{DecodeCounters, Stats};
use crate::store::{SettingsStore, Trouble};
use boot_contract::hand_over::{Cause, HandOver};
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use demod::{LevelRing, RawFrame, Reply, ReplyLevels};
use drivers::pulse_capture::CaptureCounters;
use hal::board::LED_GPIO;
use hal::{boot, timer, watchdog};
use heapless::spsc::Consumer;
use mode_s::{Frame, Message, ModeACode};
use report::{Bits, FrameReport, Moment, Statistics};
use reporter::{Context, Reporter};
use settings::Stored;
use settings::choices::RxSource;
use timebase::{Arrival, State};
use tracker::{Heard, RxPosition, Tracker};

/// Aircraft tracked at once.
pub const AIRCRAFT: usize = 400;
/// Ticks (120 MHz) a millisecond.
const TICKS_PER_MS: u64 = timer::TICKS_PER_US * 1000;
/// Time for `AT+REBOOT`'s reply to leave, microseconds.
const REBOOT_AFTER_US: u64 = 100_000;
/// Frames a turn of the loop: so that ports are served in between. A turn moves one USB packet of 64 bytes; with many more frames a turn than make a packet,
/// the console's buffer would fill although the bus is idle whenever core 0 has a backlog.
const FRAMES_A_TURN: usize = 4;
/// Standard uncertainty of a reply's arrival, 1/256 of a tick: a sample of the first sampler, 15 ticks / √12.
const REPLY_SIGMA: u16 = 1_109;
/// Mode A/C replies a turn.
const REPLIES_A_TURN: usize = 4;
/// Aircraft whose second ends in one turn of the loop: about 0.1 ms of core 0. All four hundred at once let the queue of frames overflow.
const AIRCRAFT_A_TURN: usize = 8;

/// What the cores share beside the queue: counters that core 1 writes, and wishes of core 0. One static, because a small one of its own would stand between
/// the rings, whose alignment makes it 8 KiB large.
pub struct Shared {
    /// Whether frames are taken: core 1 looks at no sample while not.
    pub is_receiving: AtomicBool,
    /// Whether a port wants refused frames: core 1 hands them on.
    pub wants_refused: AtomicBool,
    /// Whether a port wants Mode A/C replies.
    pub wants_replies: AtomicBool,
    pub capture: CaptureCounters,
    pub demod: demod::Counters,
    pub queue: QueueCounters,
    /// Core 1's sleep, microseconds.
    pub core1_idle_us: AtomicU32,
    /// Words that core 1 passed over while reception was off.
    pub unheard_words: AtomicU32,
}

/// Everything core 0 works with.
pub struct Receiver {
    pub console: Reporter<outlets::Console>,
    pub comms: Reporter<outlets::Comms>,
    pub states: States,
    /// The settings in force, and the keys of a newer version that are stored beside them.
    pub stored: Stored,
    /// What reports tell beside frames and aircraft.
    pub station: Station,
    /// Loads of the cores.
    pub load: Load,
    pub clock: Clock,
    pub queue: Consumer<'static, RawFrame>,
    pub replies: Consumer<'static, Reply>,
    /// What a reply's level is measured with.
    pub reply_levels: ReplyLevels,
    pub level_ring: &'static LevelRing,
    pub tracker: &'static mut Tracker<AIRCRAFT>,
    pub shared: &'static Shared,
    pub decode: DecodeCounters,
    pub commands: u32,
    pub comms_received: u32,
    /// Microseconds of the timer at the first sample.
    pub capture_start_us: u64,
    pub start: Option<Cause>,
    /// The second under way, of uptime, and when it ends, microseconds of uptime. The end is kept because every turn of the loop asks for it, and the core
    /// takes 150 cycles for a division of 64 bits.
    pub second: u32,
    pub second_ends_us: u64,
    /// The tracker has not ended the second that is over; then come its reports.
    pub is_ending_second: bool,
    /// Counts at the start of the second: demodulated, decoded, Mode A/C replies.
    pub last: (u32, u32, u32),
    /// When to leave, microseconds of the timer, and where to.
    pub leave: Option<(u64, Leave)>,
    pub confirm: Confirm,
    /// `a.b.c.d (Mon D YYYY)` of the image.
    pub version: Text,
    /// The board's name.
    pub board: Text,
    /// The flash part's unique id.
    pub serial: Text,
    pub air: Air,
    /// The last one since power-on.
    pub crash: Option<Crash>,
    /// Whether `AT+BOOT_USB_UF2` may be obeyed: never from the start.
    pub is_usb_drive_allowed: bool,
    pub told: Told,
    /// Where the settings are kept, and why they were not loaded at the start.
    pub store: SettingsStore,
    pub settings_trouble: Option<Trouble>,
    /// The parts that commands act on.
    pub hardware: Hardware,
}

/// Room for what tells who the device is.
pub type Text = heapless::String<32>;

/// How the image ends by command.
#[derive(Clone, Copy)]
pub enum Leave {
    /// Restarts; the bootloader is told this.
    Restart(HandOver),
    /// The ROM's USB drive.
    UsbDrive,
}

/// What messages tell beside frames and aircraft. Its fields alone are borrowed, so that the ports can be told.
macro_rules! context {
    ($receiver:ident, $now:ident) => {{
        let context: Context<'_> = $receiver.station.context(
            &$receiver.version,
            &$receiver.serial,
            &$receiver.stored.settings,
            $now,
        );
        context
    }};
}

impl Receiver {
    /// Uptime, microseconds.
    fn uptime_us(&self) -> u64 {
        timer::now_us().saturating_sub(self.capture_start_us)
    }

    /// Uptime, milliseconds.
    pub fn now_ms(&self) -> u64 {
        // From the second on in 32 bits, for the reason that `second_ends_us` gives.
        let began_us = self.second_ends_us - 1_000_000;
        let into_second_us = self.uptime_us().saturating_sub(began_us) as u32;
        u64::from(self.second) * 1000 + u64::from(into_second_us / 1000)
    }

    /// Now, on the clocks that reports name.
    fn now(&self) -> Moment {
        self.clock.moment(self.now_ms())
    }

    /// Takes frames from the queue. Returns whether more wait; `heard` is called for each.
    // A function of its own, so that `linker/app.x` can place it.
    #[inline(never)]
    pub fn frames(&mut self, mut heard: impl FnMut()) -> bool {
        let now = self.now();
        for _ in 0..FRAMES_A_TURN {
            let Some(raw_frame) = self.queue.dequeue() else {
                return false;
            };
            // Core 1 had it under way when reception ended.
            if !self.is_receiving() {
                self.decode.discarded = self.decode.discarded.wrapping_add(1);
                continue;
            }
            if !raw_frame.is_accepted() {
                self.refused(&raw_frame, now);
                continue;
            }
            heard();
            let message = Message::decode(&raw_frame.frame);
            self.decode.count(message.parity);
            let received = raw_frame.received();
            let report = self.report(&raw_frame, &received);
            let heard = Heard {
                at_ms: raw_frame.arrival / TICKS_PER_MS,
                level_cdbm: report.level_cdbm,
                quality_cdb: report.quality_cdb,
                is_repaired: raw_frame.repaired() != 0,
                since_pps_ns: report.times.since_pps_ns,
            };
            self.tracker.on_frame(&raw_frame.frame, &message, heard);
            let context = context!(self, now);
            self.console.frame(&report, true, &context);
            self.comms.frame(&report, true, &context);
        }
        self.queue.ready()
    }

    /// A frame that core 1 refused: raw outputs alone may ask for it, no decoder sees it.
    fn refused(&mut self, raw_frame: &RawFrame, now: Moment) {
        self.decode.refused = self.decode.refused.wrapping_add(1);
        let report = self.report(raw_frame, &raw_frame.frame);
        let context = context!(self, now);
        self.console.frame(&report, false, &context);
        self.comms.frame(&report, false, &context);
    }

    /// Takes Mode A/C replies from their queue. Returns whether more wait.
    pub fn replies(&mut self) -> bool {
        if !self.replies.ready() {
            return false;
        }
        let now = self.now();
        for _ in 0..REPLIES_A_TURN {
            let Some(reply) = self.replies.dequeue() else {
                return false;
            };
            if self.is_receiving() {
                self.reply(&reply, now);
            }
        }
        self.replies.ready()
    }

    fn reply(&mut self, reply: &Reply, now: Moment) {
        let code = ModeACode::of_id13(reply.pulses);
        self.tracker.on_mode_ac(code);
        if !(self.console.wants_mode_ac() || self.comms.wants_mode_ac()) {
            return;
        }
        let words = self.shared.capture.words.load(Ordering::Relaxed);
        let level_cdbm = self.reply_levels.measure(self.level_ring, words, reply);
        let quality_cdb = self.quality(level_cdbm);
        let report = FrameReport {
            bits: Bits::ModeAc {
                code,
                spi: reply.spi,
            },
            level_cdbm,
            quality_cdb,
            times: self.clock.times(Arrival {
                tick: reply.arrival,
                parts: 0,
                sigma: REPLY_SIGMA,
            }),
        };
        let context = context!(self, now);
        self.console.frame(&report, true, &context);
        self.comms.frame(&report, true, &context);
    }

    /// Level over the noise floor.
    fn quality(&self, level_cdbm: Option<i16>) -> Option<i16> {
        match (level_cdbm, self.air.floor_cdbm()) {
            (Some(level), Some(floor)) => Some(level.saturating_sub(floor).max(0)),
            _ => None,
        }
    }

    /// What raw outputs tell of a frame whose bits as received are these.
    fn report<'f>(&mut self, raw_frame: &RawFrame, received: &'f Frame) -> FrameReport<'f> {
        let quality_cdb = self.quality(raw_frame.level);
        let arrival = Arrival {
            tick: raw_frame.arrival,
            parts: raw_frame.arrival_parts,
            sigma: raw_frame.arrival_sigma,
        };
        FrameReport {
            bits: Bits::ModeS(received),
            level_cdbm: raw_frame.level,
            quality_cdb,
            times: self.clock.times(arrival),
        }
    }

    /// Whether frames are taken: in RUN, unless `RX_ENABLE=0`.
    pub fn is_receiving(&self) -> bool {
        self.states.is_receiving && self.stored.settings.rx_enable
    }

    /// Whether a port wants frames that were refused.
    pub fn wants_refused(&self) -> bool {
        self.console.wants_refused() || self.comms.wants_refused()
    }

    /// Whether a port wants Mode A/C replies, themselves or counted for each aircraft.
    pub fn wants_replies(&self) -> bool {
        self.console.asks_for_mode_ac() || self.comms.asks_for_mode_ac()
    }

    /// A look at the air: noise floor and trigger level. Gives the floor, 1/100 dBm.
    pub fn look(&mut self) -> Option<i16> {
        let words = self.shared.capture.words.load(Ordering::Relaxed);
        let frames = self.shared.queue.offered.load(Ordering::Relaxed);
        self.air.look(words, frames);
        self.hardware.set_trigger_level_low(self.air.levels_mv().0);
        self.air.floor_cdbm()
    }

    /// Begins a second when it is time; goes on with the bursts. Returns whether there is more to send at once.
    #[inline(never)]
    pub fn reports(&mut self) -> bool {
        if self.uptime_us() >= self.second_ends_us {
            self.begin_second();
        }
        if self.is_ending_second {
            if !self.tracker.go_on(AIRCRAFT_A_TURN) {
                self.is_ending_second = false;
                self.begin_reports();
            }
            return true;
        }
        let now = self.now();
        let context = context!(self, now);
        let console = self.console.turn(self.tracker, &context);
        let comms = self.comms.turn(self.tracker, &context);
        console | comms
    }

    #[inline(never)]
    fn begin_second(&mut self) {
        let now_ms = self.uptime_us() / 1000;
        self.second = (now_ms / 1000) as u32;
        self.second_ends_us = (u64::from(self.second) + 1) * 1_000_000;
        self.station.gnss = self.clock.gnss();
        self.station.second_began = self.clock.second_began();
        if self.stored.settings.rx_source == RxSource::Gnss {
            let position = self.clock.position();
            self.tracker.set_rx_position(RxPosition::Gnss(position));
        }
        self.tracker.begin_second(now_ms);
        self.is_ending_second = true;
    }

    #[inline(never)]
    fn begin_reports(&mut self) {
        self.log_second();
        let demod = self.shared.demod.snapshot();
        let (demodulated, replies) = (demod.demodulated, demod.replies);
        let statistics = Statistics {
            stamp_clock_hz: self.clock.measured_hz(),
            demodulations: Some(demodulated.wrapping_sub(self.last.0)),
            mode_s_frames: Some(self.decode.offered.wrapping_sub(self.last.1)),
            mode_ac_frames: Some(replies.wrapping_sub(self.last.2)),
            uptime_s: self.run_s(),
            load_permille: self.load.second(timer::now_us()),
            aircraft: Some(self.tracker.len() as u32),
            ..Statistics::default()
        };
        self.last = (demodulated, self.decode.offered, replies);
        let now = self.now();
        let context = context!(self, now);
        self.console.second(self.tracker, &context, &statistics);
        self.comms.second(self.tracker, &context, &statistics);
    }

    /// Serves both ports and answers what was typed. Returns whether anything moved.
    pub fn commands(&mut self, inputs: &mut Inputs) -> bool {
        let moved = inputs.serve(self);
        self.go_on_moving();
        moved
    }

    /// Takes what the GNSS receiver said. Returns whether there is more.
    pub fn listen(&mut self) -> bool {
        let (console, comms) = (&mut self.console, &mut self.comms);
        self.clock.serve(|sentence| {
            console.nmea(sentence);
            comms.nmea(sentence);
        })
    }

    /// Flashes that the LED shows each second for the state of the clock.
    pub fn marks(&self) -> u8 {
        match self.clock.state() {
            State::None => 0,
            State::Locked => 1,
            State::Holdover => 2,
            State::Coarse => 3,
        }
    }

    /// Restarts once the reply has had its time.
    pub fn reboot_soon(&mut self, words: HandOver) {
        self.leave_soon(Leave::Restart(words));
    }

    /// Ends in the ROM's USB drive, likewise.
    pub fn usb_drive_soon(&mut self) {
        self.leave_soon(Leave::UsbDrive);
    }

    fn leave_soon(&mut self, leave: Leave) {
        // Asked again it does not take longer.
        let at_us = self
            .leave
            .map_or(timer::now_us() + REBOOT_AFTER_US, |(at_us, _)| at_us);
        self.leave = Some((at_us, leave));
    }

    /// Leaves if asked to and due.
    pub fn leave_if_due(&self) {
        match self.leave {
            Some((at_us, leave)) if timer::now_us() >= at_us => match leave {
                Leave::Restart(words) => watchdog::reset(words.words()),
                Leave::UsbDrive => boot::rom_usb_drive(LED_GPIO),
            },
            _ => {}
        }
    }

    /// Where the image stands, for whoever asks after a crash.
    pub fn life(&self, stalled_ms: u32) -> Life {
        Life {
            version: self
                .confirm
                .header()
                .map_or([0; 4], |header| header.version),
            uptime_ms: self.now_ms() as u32,
            stalled_ms,
            blocks: self.shared.capture.blocks.load(Ordering::Relaxed),
            demodulated: self.shared.demod.snapshot().demodulated,
            decoded: self.decode.offered,
            dropped: self.shared.queue.dropped.load(Ordering::Relaxed),
            tracked: self.tracker.len() as u32,
        }
    }

    /// The counters of every stage.
    pub fn stats(&mut self) -> Stats<'_> {
        let i2c = self.store.bus().map(|bus| bus.counters);
        Stats {
            uptime_s: self.second,
            start: self.start,
            slot: self.confirm.slot(),
            confirmed: self.confirm.is_confirmed(),
            capture: &self.shared.capture,
            unheard_words: self.shared.unheard_words.load(Ordering::Relaxed),
            demod: &self.shared.demod,
            air: self.air.seen,
            floor_cdbm: self.air.floor_cdbm(),
            trigger_mv: self.air.levels_mv(),
            queue: &self.shared.queue,
            queue_waiting: self.queue.len(),
            decode: &self.decode,
            settings_trouble: self.settings_trouble,
            store: self.store.counts(),
            store_place: self.store.place(),
            i2c,
            tracker: self.tracker.counters(),
            tracked: self.tracker.len(),
            console: self.console.port.counters(),
            comms_uart: self.comms.port.counters(),
            commands: self.commands,
            comms_received: self.comms_received,
            comms_received_lost: self.comms.port.outlet.0.received_lost(),
            clock: self.clock.status(),
        }
    }
}
