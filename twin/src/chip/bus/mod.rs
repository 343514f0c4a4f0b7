//! The bus: address map, memories, and peripherals that advance together.
//!
//! Source: RP2040 datasheet 2.2 (address map), 2.1 (bus fabric, atomic aliases), 2.14 (RESETS).
//!
//! Peripherals stand at cycle [`Bus::now`]. A core may run ahead of it within a slice; whenever it touches a peripheral the bus first
//! advances everything to that core's own time, so that what it reads is exact. Between such moments nothing is computed: each
//! peripheral names the cycle of its next event.
//!
//! What is not modelled is an [`Fault`] that names the register, never a silent zero. So is the use of a peripheral held in reset.
//!
//! What an access costs: the table in `cpu/access.rs`, `fabric.rs` for ports that two masters want, `xip.rs` for flash.

use serde::{Deserialize, Serialize};
mod blocks;
mod cores;
pub mod debug;
mod fabric;
mod fault;
mod lines;
mod names;
mod peripherals;
mod ppb;
mod registers;
mod schedule;
mod shadow;
mod transfers;
mod used;
mod world;
mod xip;

use blocks::reset;
pub use fabric::{Fabric, sram_port};
pub use fault::{Cause, Fault, ResetCause};
use schedule::Deadlines;
pub use shadow::{Reader, Shadow, Uninitialised};
pub use used::Used;
pub use world::TriggerNet;
pub use xip::{Closed, Xip};

use super::adc::Adc;
use super::clocks::Clocks;
use super::cpu::ppb::{NMI_PENDING, Nvic, Ppb};
use super::crystal::Crystal;
use super::dma::Dma;
use super::flash::Flash;
use super::i2c::I2c;
use super::outside::Surroundings;
use super::pins::Pins;
use super::pio::Pio;
use super::psm::Psm;
use super::pwm::Pwm;
use super::qspi::Qspi;
use super::resets::Resets;
use super::sio::Sio;
use super::spi::Spi;
use super::syscfg::Syscfg;
use super::systick::SysTick;
use super::time::Instant;
use super::timer::Timer;
use super::trace::Trace;
use super::uart::Uart;
use super::usb::{DPRAM, Usb};
use super::usb_host::UsbHost;
use super::watchdog::Watchdog;

/// How far PIO runs in one go while something plays, cycles: 100 µs.
const LOOK_AHEAD: u64 = 12_000;

/// SRAM: four striped 64 KiB banks and two of 4 KiB (datasheet 2.6.2).
pub const SRAM: usize = 264 * 1024;
pub const SRAM_BASE: u32 = 0x2000_0000;
/// Mask ROM.
pub const ROM: usize = 16 * 1024;

/// IRQ numbers (datasheet 2.3.2).
mod irq {
    pub const TIMER_0: u32 = 0;
    pub const PWM_WRAP: u32 = 4;
    pub const USBCTRL: u32 = 5;
    pub const PIO0_0: u32 = 7;
    pub const DMA_0: u32 = 11;
    pub const IO_BANK0: u32 = 13;
    pub const SIO_PROC0: u32 = 15;
    pub const CLOCKS: u32 = 17;
    pub const SPI0: u32 = 18;
    pub const UART0: u32 = 20;
    pub const ADC_FIFO: u32 = 22;
    pub const I2C0: u32 = 23;
}

/// Memories, peripherals, and the state both cores share.
#[derive(Clone, Serialize, Deserialize)]
pub struct Bus {
    pub rom: Vec<u8>,
    pub flash: Flash,
    #[serde(with = "crate::snapshot::array")]
    pub sram: Box<[u8; SRAM]>,
    pub fabric: Fabric,
    pub xip: Xip,
    /// Which bytes of SRAM were written, while that is watched.
    #[serde(skip)]
    pub shadow: Option<Box<Shadow>>,
    /// What a debugger wants, while one is attached.
    #[serde(skip)]
    pub debug: Option<Box<debug::Debug>>,
    /// Signals that are being recorded.
    #[serde(skip)]
    pub trace: Option<Box<Trace>>,
    /// Peripherals have been advanced to this cycle.
    pub now: u64,
    /// Time of the core that is executing, and which one it is.
    pub core_time: u64,
    pub active: usize,
    pub active_pc: u32,
    /// Something in the last instruction wants more than the inner loop does.
    pub attention: bool,
    /// The last instruction was in ROM.
    pub rom_called: bool,
    /// Words core 1 fetched or read from flash since it was started by the program.
    pub core1_xip: u64,
    /// The address of the first of them.
    pub core1_xip_first: u32,
    pub ppb: [Ppb; 2],
    pub nvic: [Nvic; 2],
    pub event: [bool; 2],
    pub event_time: u64,
    #[serde(skip)]
    pub fault: Option<Fault>,
    pub reset_request: Option<ResetCause>,
    pub core1_forced_off: bool,
    /// The run ends here for now: a flash operation that was waited for has begun.
    pub paused: bool,
    /// Core 0 pushed a word to a core 1 that still waits in ROM.
    pub core1_launching: bool,
    lines: [u32; 2],
    /// Interrupt lines may have changed since they were computed.
    lines_dirty: bool,
    /// No peripheral has anything to do before this cycle; zero while that is not known.
    quiet_until: u64,
    /// Cycle at which a sleeping core's wake-up became pending.
    pub wake_at: [Option<u64>; 2],
    /// Set for cores that sleep; the bus then watches their lines. An event alone wakes those of `wfe`.
    pub asleep: [bool; 2],
    pub wfe: [bool; 2],
    dma_at: u64,
    deadlines: Deadlines,
    /// Registers touched, while somebody wants to know.
    #[serde(skip)]
    used: Option<Box<Used>>,
    /// The cycle at which the DMA can make its next transfer.
    dma_free: u64,
    pub pio: [Pio; 2],
    pub dma: Dma,
    pub uart: [Uart; 2],
    pub i2c: [I2c; 2],
    pub spi: [Spi; 2],
    pub qspi: Qspi,
    pub adc: Adc,
    pub timer: Timer,
    pub systick: [SysTick; 2],
    pub syscfg: Syscfg,
    /// The core's NMI input, as it was.
    nmi: [bool; 2],
    pub watchdog: Watchdog,
    pub clocks: Clocks,
    pub sio: Sio,
    pub pins: Pins,
    pub pwm: Pwm,
    pub usb: Usb,
    pub usb_host: UsbHost,
    resets: Resets,
    pub psm: Psm,
    sys_hz: u64,
    /// Picoseconds at cycle `since`, when the system clock last changed.
    time_ps: u128,
    since: u64,
    /// The chip's time against true time.
    pub crystal: Crystal,
    /// What is attached and acts by itself.
    pub surroundings: Surroundings,
    /// The board's trigger levels; the first is the comparator's.
    pub trigger_nets: Vec<TriggerNet>,
    /// ADC channel of the RSSI net.
    pub rssi_adc: Option<usize>,
}

impl Bus {
    /// A chip with `flash`, at power-on.
    pub fn new(flash: Flash) -> Self {
        let mut bus = Self {
            rom: vec![0; ROM],
            flash,
            sram: Box::new([0; SRAM]),
            fabric: Fabric::default(),
            xip: Xip::default(),
            shadow: None,
            debug: None,
            trace: None,
            now: 0,
            core_time: 0,
            active: 0,
            active_pc: 0,
            attention: false,
            rom_called: false,
            core1_xip: 0,
            core1_xip_first: 0,
            ppb: [Ppb::new(), Ppb::new()],
            nvic: [Nvic::new(), Nvic::new()],
            event: [false; 2],
            event_time: 0,
            fault: None,
            reset_request: None,
            core1_forced_off: false,
            paused: false,
            core1_launching: false,
            lines: [0; 2],
            lines_dirty: true,
            quiet_until: 0,
            wake_at: [None; 2],
            asleep: [false; 2],
            wfe: [false; 2],
            dma_at: u64::MAX,
            deadlines: Deadlines::default(),
            used: None,
            dma_free: 0,
            pio: [Pio::new(), Pio::new()],
            dma: Dma::default(),
            uart: [Uart::default(), Uart::default()],
            i2c: [I2c::new(0), I2c::new(1)],
            spi: [Spi::default(), Spi::default()],
            qspi: Qspi::default(),
            adc: Adc::default(),
            timer: Timer::default(),
            systick: [SysTick::default(); 2],
            syscfg: Syscfg::default(),
            nmi: [false; 2],
            watchdog: Watchdog::default(),
            clocks: Clocks::default(),
            sio: Sio::default(),
            pins: Pins::new(),
            pwm: Pwm::default(),
            usb: Usb::default(),
            usb_host: UsbHost::default(),
            resets: Resets::new(reset::BY_ROM),
            psm: Psm::default(),
            sys_hz: 0,
            time_ps: 0,
            since: 0,
            crystal: Crystal::default(),
            surroundings: Surroundings::new(),
            trigger_nets: Vec::new(),
            rssi_adc: None,
        };
        bus.clocks_changed();
        bus
    }

    /// Everything back to its reset state but what survives: memories, scratch words, what is attached outside.
    pub fn reset(&mut self, cause: ResetCause) {
        let oscillators = match cause {
            ResetCause::PowerOn => true,
            ResetCause::Software => false,
            ResetCause::WatchdogTimer | ResetCause::WatchdogForced => {
                self.psm.watchdog_stops_oscillators()
            }
        };
        self.apply_resets(reset::ALL);
        self.resets = Resets::new(reset::BY_ROM);
        self.psm = Psm::default();
        self.flash.reset();
        self.xip.reset();
        self.fabric.priority = 0;
        self.clocks.reset(oscillators);
        self.sio = Sio::default();
        match cause {
            ResetCause::PowerOn => {
                self.watchdog = Watchdog::default();
                self.sram.fill(0);
            }
            ResetCause::Software => self.watchdog.reason = 0,
            ResetCause::WatchdogTimer | ResetCause::WatchdogForced => {}
        }
        self.ppb = [Ppb::new(), Ppb::new()];
        self.nvic = [Nvic::new(), Nvic::new()];
        self.systick = [SysTick::default(); 2];
        self.nmi = [false; 2];
        self.event = [false; 2];
        self.wake_at = [None; 2];
        self.asleep = [false; 2];
        self.wfe = [false; 2];
        self.lines = [0; 2];
        self.lines_dirty = true;
        self.quiet_until = 0;
        self.core1_forced_off = false;
        self.core1_launching = false;
        self.usb_host.device_reset();
        self.resolve_pins();
        self.clocks_changed();
    }

    /// System clock in Hz.
    pub fn sys_hz(&self) -> u64 {
        self.sys_hz
    }

    // ---- time --------------------------------------------------------------------------------------------------------------

    /// Time since power-on in picoseconds as the chip counts it: by its own crystal.
    pub fn time_ps(&self) -> u128 {
        match self.sys_hz {
            0 => self.time_ps,
            hz => {
                self.time_ps
                    + u128::from(self.now - self.since) * 1_000_000_000_000 / u128::from(hz)
            }
        }
    }

    /// This moment, in the time of what lies outside.
    pub(super) fn instant(&mut self) -> Instant {
        Instant {
            cycle: self.now,
            time_ps: self.true_ps(),
            sys_hz: self.sys_hz,
        }
    }

    fn clocks_changed(&mut self) {
        self.deadlines.forget();
        self.time_ps = self.time_ps();
        self.since = self.now;
        self.sys_hz = self.clocks.sys_hz();
        if self.sys_hz == 0
            && let Some(us) = self.clocks.resuscitate()
        {
            self.time_ps += u128::from(us) * 1_000_000;
            self.sys_hz = self.clocks.sys_hz();
        }
        self.pins.clock_changed(self.now, self.sys_hz);
        self.time_surroundings();
        if self.sys_hz == 0 {
            self.fault.get_or_insert(Fault::ClockStopped);
            return;
        }
        let tick = match (self.watchdog.tick_divider(), self.clocks.ref_hz()) {
            (Some(divider), hz) if hz > 0 => self.sys_hz * u64::from(divider) / hz,
            _ => 0,
        };
        for uart in &mut self.uart {
            uart.set_clock(self.clocks.peri_hz(), self.sys_hz);
        }
        for spi in &mut self.spi {
            spi.set_clock(self.clocks.peri_hz(), self.sys_hz);
        }
        self.adc
            .set_clock(self.clocks.adc_hz(), self.sys_hz, self.now);
        for systick in &mut self.systick {
            systick.set_reference(tick, self.now);
        }
        self.timer.set_tick(tick, self.now);
        self.watchdog.set_tick(tick, self.now);
    }

    /// Brings all peripherals to cycle `to`.
    pub fn advance(&mut self, to: u64) {
        self.advance_until(to, false);
    }

    /// Brings all peripherals to cycle `to`, or only to the first cycle at which a sleeping core is woken if `stop_on_wake` is set.
    pub fn advance_until(&mut self, to: u64, stop_on_wake: bool) {
        if to <= self.now {
            return;
        }
        self.pins.now = to;
        if to < self.quiet_until && self.trace.is_none() {
            self.now = to;
            return;
        }
        loop {
            let event = self.next_event();
            let mut limit = event.min(to);
            if self.trace.is_some() {
                limit = limit.min(self.now + 1);
            }
            // PIO runs to its first visible effect before the next event of anything else.
            let (a, b) = (self.pio[0].next_tick(), self.pio[1].next_tick());
            let mut visible = false;
            if a.min(b) <= limit {
                // Never far ahead: the front end forgets levels that the converter may still ask for.
                self.pins.look_ahead(limit.min(self.now + LOOK_AHEAD));
                limit = limit.min(self.now + LOOK_AHEAD);
                let (first, other) = if b < a { (1, a) } else { (0, b) };
                let bound = limit.min(other);
                limit = self.pio[first].run(bound, &mut self.pins);
                visible = self.pio[first].take_visible();
                self.now = self.now.max(limit);
                if self.pio[first].take_pads_changed() {
                    // What a state machine writes in one cycle is on the pads in the next.
                    self.resolve_pins_at(self.now + 1);
                }
            }
            self.now = self.now.max(limit);
            if self.trace.is_some() {
                self.pins.synced(self.now, 0);
                self.sample_trace();
            }
            if visible || event <= self.now {
                self.fire();
                if stop_on_wake && self.wake_at != [None; 2] {
                    break;
                }
            }
            if self.now >= to {
                let next = self.next_event().min(self.next_pio());
                if next > to {
                    self.quiet_until = next;
                    return;
                }
            }
        }
        self.quiet_until = 0;
    }

    fn next_pio(&self) -> u64 {
        self.pio[0].next_tick().min(self.pio[1].next_tick())
    }

    // ---- interrupts --------------------------------------------------------------------------------------------------------

    fn compute_lines(&self) -> [u32; 2] {
        let mut lines = self.timer.irq_lines() << irq::TIMER_0;
        lines |= u32::from(self.usb.irq_line()) << irq::USBCTRL;
        lines |= u32::from(self.pwm.irq_line()) << irq::PWM_WRAP;
        lines |= u32::from(self.clocks.irq_line()) << irq::CLOCKS;
        lines |= u32::from(self.adc.irq_line()) << irq::ADC_FIFO;
        for block in 0..2 {
            for line in 0..2 {
                lines |= u32::from(self.pio[block].irq_line(line))
                    << (irq::PIO0_0 + 2 * block as u32 + line as u32);
            }
            lines |= u32::from(self.dma.irq_line(block)) << (irq::DMA_0 + block as u32);
            lines |= u32::from(self.uart[block].irq_line()) << (irq::UART0 + block as u32);
            lines |= u32::from(self.spi[block].irq_line()) << (irq::SPI0 + block as u32);
            lines |= u32::from(self.i2c[block].irq_line()) << (irq::I2C0 + block as u32);
        }
        std::array::from_fn(|core| {
            lines
                | u32::from(self.pins.irq_line(core)) << irq::IO_BANK0
                | u32::from(self.sio.irq_line(core)) << (irq::SIO_PROC0 + core as u32)
        })
    }

    /// Level interrupts become pending unless their handler runs already; sleeping cores note when they were woken.
    pub fn update_lines(&mut self) {
        if std::mem::take(&mut self.lines_dirty) {
            self.lines = self.compute_lines();
            self.update_nmi();
        }
        if self.lines == [0; 2] && self.asleep == [false; 2] {
            return;
        }
        for core in 0..2 {
            let active = (self.ppb[core].active >> 16) as u32;
            self.nvic[core].pending |= self.lines[core] & !active;
            if self.asleep[core] && self.wake_at[core].is_none() && self.can_wake(core) {
                self.wake_at[core] = Some(self.now);
            }
        }
    }

    /// A line that SYSCFG lets through to NMI makes it pending where it rises.
    fn update_nmi(&mut self) {
        for core in 0..2 {
            let level = self.lines[core] & self.syscfg.nmi_mask[core] != 0;
            if level && !self.nmi[core] {
                self.ppb[core].icsr |= NMI_PENDING;
            }
            self.nmi[core] = level;
        }
    }

    /// A sleeping core has a reason to go on.
    pub fn can_wake(&self, core: usize) -> bool {
        let interrupt = self.nvic[core].pending_and_enabled() != 0
            || self.ppb[core].icsr & (1 << 31 | 1 << 28 | 1 << 26) != 0;
        // WFE with interrupts masked needs SEVONPEND, which no image uses; an enabled pending interrupt wakes it as WFI.
        interrupt || (self.wfe[core] && self.event[core])
    }
}
