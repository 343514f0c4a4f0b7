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
//! Not modelled: bus contention, XIP cache misses (cycle counts are optimistic for code in flash), SRAM banks.

use rp2040_emu::bus::ppb::Ppb;
use rp2040_emu::core::{CoreBus, Nvic};

use super::clocks::Clocks;
use super::dma::Dma;
use super::flash::Flash;
use super::pins::{Drivers, Pins};
use super::pio::Pio;
use super::pwm::Pwm;
use super::sio::{Effect, Sio};
use super::timer::{Timer, Watchdog};
use super::uart::Uart;
use super::usb::{DPRAM, Usb};
use super::usb_host::UsbHost;

/// SRAM: four striped 64 KiB banks and two of 4 KiB (datasheet 2.6.2).
pub const SRAM: usize = 264 * 1024;
const SRAM_BASE: u32 = 0x2000_0000;
/// Granule in which the bus remembers where code was fetched from SRAM.
const CODE_GRANULE: usize = 256;
/// Mask ROM.
pub const ROM: usize = 16 * 1024;

/// RESETS bits of what the model resets.
mod reset {
    pub const DMA: u32 = 1 << 2;
    pub const IO_BANK0: u32 = 1 << 5;
    pub const PADS_BANK0: u32 = 1 << 8;
    pub const PIO0: u32 = 1 << 10;
    pub const PIO1: u32 = 1 << 11;
    pub const PLL_SYS: u32 = 1 << 12;
    pub const PLL_USB: u32 = 1 << 13;
    pub const PWM: u32 = 1 << 14;
    pub const TIMER: u32 = 1 << 21;
    pub const UART0: u32 = 1 << 22;
    pub const UART1: u32 = 1 << 23;
    pub const USBCTRL: u32 = 1 << 24;
    pub const ALL: u32 = 0x01ff_ffff;
}

/// IRQ numbers (datasheet 2.3.2).
mod irq {
    pub const TIMER_0: u32 = 0;
    pub const USBCTRL: u32 = 5;
    pub const PIO0_0: u32 = 7;
    pub const DMA_0: u32 = 11;
    pub const IO_BANK0: u32 = 13;
    pub const SIO_PROC0: u32 = 15;
    pub const UART0: u32 = 20;
}

/// Why the chip stopped. Each names the address and where the program was.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    #[error("{access} of {register} ({address:#010x}) is not modelled")]
    NotModelled {
        access: &'static str,
        register: String,
        address: u32,
    },
    #[error(
        "{access} of {register} ({address:#010x}) while the peripheral is held in reset (RESETS)"
    )]
    HeldInReset {
        access: &'static str,
        register: String,
        address: u32,
    },
    #[error("ROM code at {address:#06x} is not modelled")]
    Rom { address: u32 },
    #[error("ROM function '{0}' is not modelled")]
    RomFunction(String),
    #[error("boot2 fails its CRC-32: the flash holds no bootable image")]
    Boot2,
    #[error("core {core} is in HardFault at {pc:#010x}")]
    HardFault { core: usize, pc: u32 },
    #[error("flash operation outside the chip or not aligned: {offset:#x}+{len:#x}")]
    FlashRange { offset: u32, len: u32 },
    #[error(
        "a watchdog reset with PSM_WDSEL={0:#x} would reset only part of the chip, which is not modelled"
    )]
    PartialReset(u32),
    #[error("the system clock stopped (clk_sys has no running source)")]
    ClockStopped,
}

/// What made the chip start again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResetCause {
    PowerOn,
    WatchdogTimer,
    WatchdogForced,
    Software,
}

/// Memories, peripherals, and the state both cores share.
pub struct Bus {
    pub rom: Vec<u8>,
    pub flash: Flash,
    pub sram: Vec<u8>,
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
    /// Instructions core 1 executed, and data it read, from flash since it was started by the program.
    pub core1_xip: u64,
    /// The address of the first of them.
    pub core1_xip_first: u32,
    pub ppb: [Ppb; 2],
    pub nvic: [Nvic; 2],
    pub event: [bool; 2],
    pub event_time: u64,
    pub wfe: [bool; 2],
    bus_fault: Option<u32>,
    pub fault: Option<Fault>,
    pub reset_request: Option<ResetCause>,
    pub core1_forced_off: bool,
    /// Core 0 pushed a word to a core 1 that still waits in ROM.
    pub core1_launching: bool,
    pub stale_code: Vec<u32>,
    code: Vec<bool>,
    lines: [u32; 2],
    /// Interrupt lines may have changed since they were computed.
    lines_dirty: bool,
    /// No peripheral has anything to do before this cycle; zero while that is not known.
    quiet_until: u64,
    /// Cycle at which a sleeping core's wake-up became pending.
    pub wake_at: [Option<u64>; 2],
    /// Set for cores that sleep; the bus then watches their lines.
    pub asleep: [bool; 2],
    dma_at: u64,
    pub pio: [Pio; 2],
    pub dma: Dma,
    pub uart: [Uart; 2],
    pub timer: Timer,
    pub watchdog: Watchdog,
    pub clocks: Clocks,
    pub sio: Sio,
    pub pins: Pins,
    pub pwm: Pwm,
    pub usb: Usb,
    pub usb_host: UsbHost,
    resets: u32,
    resets_wdsel: u32,
    psm_off: u32,
    pub psm_wdsel: u32,
    chip_reset: u32,
    storage: [u32; 8],
    sys_hz: u64,
    /// Picoseconds at cycle `since`, when the system clock last changed.
    time_ps: u128,
    since: u64,
}

/// Pin of the trigger level's PWM (board table), and the supply its duty is a share of.
const TRIGGER_LEVEL_GPIO: usize = 25;
const SUPPLY_MV: f64 = 3300.0;

impl Bus {
    /// A chip with `flash`, at power-on.
    pub fn new(flash: Flash) -> Self {
        let mut bus = Self {
            rom: vec![0; ROM],
            flash,
            sram: vec![0; SRAM],
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
            wfe: [false; 2],
            bus_fault: None,
            fault: None,
            reset_request: None,
            core1_forced_off: false,
            core1_launching: false,
            stale_code: Vec::new(),
            code: vec![false; SRAM / CODE_GRANULE],
            lines: [0; 2],
            lines_dirty: true,
            quiet_until: 0,
            wake_at: [None; 2],
            asleep: [false; 2],
            dma_at: u64::MAX,
            pio: [Pio::new(), Pio::new()],
            dma: Dma::default(),
            uart: [Uart::default(), Uart::default()],
            timer: Timer::default(),
            watchdog: Watchdog::default(),
            clocks: Clocks::default(),
            sio: Sio::default(),
            pins: Pins::new(),
            pwm: Pwm::default(),
            usb: Usb::default(),
            usb_host: UsbHost::default(),
            resets: reset::ALL,
            resets_wdsel: 0,
            psm_off: 0,
            psm_wdsel: 0,
            chip_reset: 1 << 8,
            storage: [0; 8],
            sys_hz: 0,
            time_ps: 0,
            since: 0,
        };
        bus.clocks_changed();
        bus
    }

    /// Everything back to its reset state but what survives: memories, scratch words, what is attached outside.
    pub fn reset(&mut self, cause: ResetCause) {
        self.apply_resets(reset::ALL);
        self.resets = reset::ALL;
        self.resets_wdsel = 0;
        self.psm_off = 0;
        self.psm_wdsel = 0;
        self.flash.reset();
        self.clocks.reset();
        self.sio = Sio::default();
        self.watchdog.reset(self.now);
        match cause {
            ResetCause::PowerOn => {
                self.watchdog = Watchdog::default();
                self.chip_reset = 1 << 8;
                self.sram.fill(0);
            }
            ResetCause::Software => self.watchdog.reason = 0,
            ResetCause::WatchdogTimer | ResetCause::WatchdogForced => {}
        }
        self.ppb = [Ppb::new(), Ppb::new()];
        self.nvic = [Nvic::new(), Nvic::new()];
        self.event = [false; 2];
        self.wfe = [false; 2];
        self.wake_at = [None; 2];
        self.asleep = [false; 2];
        self.lines = [0; 2];
        self.lines_dirty = true;
        self.quiet_until = 0;
        self.storage = [0; 8];
        self.core1_forced_off = false;
        self.core1_launching = false;
        self.code.fill(false);
        self.stale_code.clear();
        self.usb_host.device_reset();
        self.resolve_pins();
        self.clocks_changed();
    }

    /// System clock in Hz.
    pub fn sys_hz(&self) -> u64 {
        self.sys_hz
    }

    // ---- time --------------------------------------------------------------------------------------------------------------

    /// Time since power-on in picoseconds.
    pub fn time_ps(&self) -> u128 {
        match self.sys_hz {
            0 => self.time_ps,
            hz => {
                self.time_ps
                    + u128::from(self.now - self.since) * 1_000_000_000_000 / u128::from(hz)
            }
        }
    }

    /// Hands the threshold that the PWM makes to the front end.
    pub fn apply_trigger_level(&mut self) {
        if self.pins.function(TRIGGER_LEVEL_GPIO) == 4
            && let Some(duty) = self.pwm.duty(TRIGGER_LEVEL_GPIO)
        {
            self.pins.set_trigger_level_mv(duty * SUPPLY_MV);
        }
    }

    fn clocks_changed(&mut self) {
        self.time_ps = self.time_ps();
        self.since = self.now;
        self.sys_hz = self.clocks.sys_hz();
        if self.sys_hz == 0 {
            self.fault.get_or_insert(Fault::ClockStopped);
            return;
        }
        let tick = match (self.watchdog.tick_divider(), self.clocks.ref_hz()) {
            (Some(divider), hz) if hz > 0 => self.sys_hz * u64::from(divider) / hz,
            _ => 0,
        };
        self.timer.set_tick(tick, self.now);
        self.watchdog.set_tick(tick, self.now);
    }

    /// Cycle of the next event of any peripheral but PIO.
    fn next_event(&self) -> u64 {
        self.timer
            .next_event()
            .min(self.watchdog.next_event())
            .min(self.uart[0].next_event())
            .min(self.uart[1].next_event())
            .min(self.usb_host.next_event())
            .min(self.dma_at)
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
        if to < self.quiet_until {
            self.now = to;
            return;
        }
        if self.next_pio() <= to {
            self.pins.look_ahead(to);
        }
        loop {
            let event = self.next_event();
            let mut limit = event.min(to);
            // PIO runs to its first visible effect before the next event of anything else.
            let (a, b) = (self.pio[0].next_tick(), self.pio[1].next_tick());
            let mut visible = false;
            if a.min(b) <= limit {
                let (first, other) = if b < a { (1, a) } else { (0, b) };
                let bound = limit.min(other);
                limit = self.pio[first].run(bound, &mut self.pins);
                visible = self.pio[first].take_visible();
                if visible && self.pio[first].pad_oe != 0 {
                    self.resolve_pins();
                }
            }
            self.now = self.now.max(limit);
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

    /// Everything due at `now`, then the interrupt lines.
    fn fire(&mut self) {
        let now = self.now;
        if self.timer.next_event() <= now {
            self.timer.advance(now);
        }
        for u in &mut self.uart {
            if u.next_event() <= now {
                u.advance(now);
            }
        }
        if self.usb_host.next_event() <= now {
            let per_ms = self.sys_hz / 1000;
            self.usb_host.advance(&mut self.usb, now, per_ms);
        }
        if self.watchdog.next_event() <= now
            && self.watchdog.bites(now)
            && self.reset_request.is_none()
        {
            self.reset_request = Some(ResetCause::WatchdogTimer);
            // Bites once; the reset clears it.
            let _ = self.watchdog.write(0, 0, now);
        }
        if self.dma.busy != 0 {
            self.move_data();
        } else {
            self.dma_at = u64::MAX;
        }
        self.lines_dirty = true;
        self.update_lines();
    }

    // ---- DMA ---------------------------------------------------------------------------------------------------------------

    fn dreq(&self, number: u32) -> bool {
        let n = number as usize;
        match number {
            0..=3 => self.pio[0].tx_ready(n),
            4..=7 => self.pio[0].rx_ready(n - 4),
            8..=11 => self.pio[1].tx_ready(n - 8),
            12..=15 => self.pio[1].rx_ready(n - 12),
            20 => self.uart[0].tx_ready(),
            21 => self.uart[0].rx_ready(),
            22 => self.uart[1].tx_ready(),
            23 => self.uart[1].rx_ready(),
            0x3f => true,
            _ => false,
        }
    }

    /// One transfer, and the cycle of the next.
    fn move_data(&mut self) {
        let Some(n) = self.dma.pick(|d| self.dreq(d)) else {
            // Nothing is ready: the next transfer follows the next event that makes a DREQ.
            self.dma_at = u64::MAX;
            return;
        };
        let c = self.dma.channels[n];
        match c.size() {
            1 => {
                let byte = self.load(c.read_addr & !3) >> (8 * (c.read_addr & 3));
                self.store_narrow(c.write_addr, byte & 0xff, 1);
            }
            2 => {
                let half = self.load(c.read_addr & !3) >> (8 * (c.read_addr & 2));
                self.store_narrow(c.write_addr, half & 0xffff, 2);
            }
            _ => {
                let word = self.load(c.read_addr);
                let word = if c.byte_swap() {
                    word.swap_bytes()
                } else {
                    word
                };
                self.store(c.write_addr, word);
            }
        }
        self.dma.transferred(n);
        self.dma_at = self.now + 1;
    }

    /// A word as a bus master other than the cores reads it.
    fn load(&mut self, address: u32) -> u32 {
        match self.memory(address, 4) {
            Some(bytes) => u32::from_le_bytes(bytes.try_into().expect("four bytes")),
            None => self.peripheral_read(address),
        }
    }

    fn store(&mut self, address: u32, value: u32) {
        match self.sram_offset(address, 4) {
            Some(at) => self.sram[at..at + 4].copy_from_slice(&value.to_le_bytes()),
            None => self.peripheral_write(address, value),
        }
    }

    fn store_narrow(&mut self, address: u32, value: u32, size: usize) {
        match self.sram_offset(address, size) {
            Some(at) => self.sram[at..at + size].copy_from_slice(&value.to_le_bytes()[..size]),
            None => self.peripheral_write_narrow(address, value, size),
        }
    }

    // ---- memories ----------------------------------------------------------------------------------------------------------

    #[inline]
    fn sram_offset(&self, address: u32, size: usize) -> Option<usize> {
        let at = address.wrapping_sub(SRAM_BASE) as usize;
        (at <= SRAM - size).then_some(at)
    }

    #[inline]
    fn memory(&self, address: u32, size: usize) -> Option<&[u8]> {
        match address >> 24 {
            0x20 => self
                .sram_offset(address, size)
                .map(|at| &self.sram[at..at + size]),
            0x10..=0x13 => {
                let at = (address & 0x00ff_ffff) as usize;
                self.flash.bytes.get(at..at + size)
            }
            0x00 => self.rom.get(address as usize..address as usize + size),
            _ => None,
        }
    }

    /// A core reads memory: counts core 1's use of flash and remembers where code lies in SRAM.
    #[inline(always)]
    fn core_memory<const SIZE: usize>(&mut self, address: u32) -> Option<[u8; SIZE]> {
        if let Some(at) = self.sram_offset(address, SIZE) {
            if address & !3 == self.active_pc & !3 {
                self.note_code(at);
            }
            return self.sram[at..at + SIZE].try_into().ok();
        }
        if address >> 28 == 1 && self.active == 1 {
            self.note_core1_xip(address);
        }
        self.memory(address, SIZE)?.try_into().ok()
    }

    #[cold]
    fn note_core1_xip(&mut self, address: u32) {
        if self.core1_xip == 0 {
            self.core1_xip_first = address;
        }
        self.core1_xip += 1;
    }

    fn note_code(&mut self, at: usize) {
        self.code[at / CODE_GRANULE] = true;
        let next = ((at + 2) / CODE_GRANULE).min(self.code.len() - 1);
        self.code[next] = true;
    }

    #[inline]
    fn note_write(&mut self, at: usize, address: u32) {
        if self.code[at / CODE_GRANULE] {
            self.stale_code.push(address & !3);
            self.stale_code.push((address & !3) + 2);
            self.attention = true;
        }
    }

    // ---- interrupts --------------------------------------------------------------------------------------------------------

    fn compute_lines(&self) -> [u32; 2] {
        let mut lines = self.timer.irq_lines() << irq::TIMER_0;
        lines |= u32::from(self.usb.irq_line()) << irq::USBCTRL;
        for block in 0..2 {
            for line in 0..2 {
                lines |= u32::from(self.pio[block].irq_line(line))
                    << (irq::PIO0_0 + 2 * block as u32 + line as u32);
            }
            lines |= u32::from(self.dma.irq_line(block)) << (irq::DMA_0 + block as u32);
            lines |= u32::from(self.uart[block].irq_line()) << (irq::UART0 + block as u32);
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

    /// A sleeping core has a reason to go on.
    pub fn can_wake(&self, core: usize) -> bool {
        let interrupt = self.nvic[core].pending_and_enabled() != 0
            || self.ppb[core].icsr & (1 << 28 | 1 << 26) != 0;
        // WFE with interrupts masked needs SEVONPEND, which no image uses; an enabled pending interrupt wakes it as WFI.
        interrupt || (self.wfe[core] && self.event[core])
    }

    // ---- pins --------------------------------------------------------------------------------------------------------------

    fn resolve_pins(&mut self) {
        let drivers = Drivers {
            sio_out: self.sio.out,
            sio_oe: self.sio.oe,
            pio: [0, 1].map(|n| (self.pio[n].pad_out, self.pio[n].pad_oe)),
        };
        self.pins.resolve(&drivers);
    }

    // ---- peripherals -------------------------------------------------------------------------------------------------------

    fn apply_resets(&mut self, bits: u32) {
        let now = self.now;
        let on = |bit: u32| bits & bit != 0;
        if on(reset::DMA) {
            self.dma = Dma::default();
        }
        if on(reset::IO_BANK0) || on(reset::PADS_BANK0) {
            self.pins.reset();
        }
        if on(reset::PIO0) {
            self.pio[0] = Pio::new();
        }
        if on(reset::PIO1) {
            self.pio[1] = Pio::new();
        }
        if on(reset::PLL_SYS) {
            self.clocks.reset_pll(0);
        }
        if on(reset::PLL_USB) {
            self.clocks.reset_pll(1);
        }
        if on(reset::PWM) {
            self.pwm = Pwm::default();
        }
        if on(reset::TIMER) {
            self.timer.reset(now);
        }
        if on(reset::UART0) {
            self.uart[0].reset();
        }
        if on(reset::UART1) {
            self.uart[1].reset();
        }
        if on(reset::USBCTRL) {
            self.usb = Usb::default();
        }
        self.resolve_pins();
    }

    /// RESETS bit that gates a peripheral, by the base of its address.
    fn gate(base: u32) -> u32 {
        match base {
            0x4001_4000 => reset::IO_BANK0,
            0x4001_c000 => reset::PADS_BANK0,
            0x4003_4000 => reset::UART0,
            0x4003_8000 => reset::UART1,
            0x4005_0000 => reset::PWM,
            0x4005_4000 => reset::TIMER,
            0x5000_0000 => reset::DMA,
            0x5010_0000 | 0x5011_0000 => reset::USBCTRL,
            0x5020_0000 => reset::PIO0,
            0x5030_0000 => reset::PIO1,
            0x4002_8000 => reset::PLL_SYS,
            0x4002_c000 => reset::PLL_USB,
            _ => 0,
        }
    }

    fn name(base: u32) -> &'static str {
        match base {
            0x4000_0000 => "SYSINFO",
            0x4000_4000 => "SYSCFG",
            0x4000_8000 => "CLOCKS",
            0x4000_c000 => "RESETS",
            0x4001_0000 => "PSM",
            0x4001_4000 => "IO_BANK0",
            0x4001_8000 => "IO_QSPI",
            0x4001_c000 => "PADS_BANK0",
            0x4002_0000 => "PADS_QSPI",
            0x4002_4000 => "XOSC",
            0x4002_8000 => "PLL_SYS",
            0x4002_c000 => "PLL_USB",
            0x4003_0000 => "BUSCTRL",
            0x4003_4000 => "UART0",
            0x4003_8000 => "UART1",
            0x4003_c000 => "SPI0",
            0x4004_0000 => "SPI1",
            0x4004_4000 => "I2C0",
            0x4004_8000 => "I2C1",
            0x4004_c000 => "ADC",
            0x4005_0000 => "PWM",
            0x4005_4000 => "TIMER",
            0x4005_8000 => "WATCHDOG",
            0x4005_c000 => "RTC",
            0x4006_0000 => "ROSC",
            0x4006_4000 => "VREG_AND_CHIP_RESET",
            0x4006_c000 => "TBMAN",
            0x5000_0000 => "DMA",
            0x5010_0000 => "USBCTRL_DPRAM",
            0x5011_0000 => "USBCTRL_REGS",
            0x5020_0000 => "PIO0",
            0x5030_0000 => "PIO1",
            0x1400_0000 => "XIP_CTRL",
            0x1800_0000 => "SSI",
            0xd000_0000 => "SIO",
            0xe000_c000 => "PPB",
            _ => "unknown",
        }
    }

    fn register(address: u32) -> String {
        let base = match address >> 28 {
            0x4 | 0x5 => address & 0xffff_c000,
            0xe => address & 0xffff_c000,
            _ => address & 0xff00_0000,
        };
        format!("{}+{:#05x}", Self::name(base), address & 0xfff)
    }

    fn not_modelled(&mut self, access: &'static str, address: u32) {
        self.fault.get_or_insert(Fault::NotModelled {
            access,
            register: Self::register(address),
            address,
        });
    }

    fn peripheral_read(&mut self, address: u32) -> u32 {
        let base = address & 0xffff_c000;
        let offset = address & 0xfff;
        if self.resets & Self::gate(base) != 0 {
            self.fault.get_or_insert(Fault::HeldInReset {
                access: "read",
                register: Self::register(address),
                address,
            });
            return 0;
        }
        let now = self.now;
        let value = match address >> 28 {
            0x1 => self.read_flash_interface(address),
            0xd => {
                let pins = self.pins.synced(now, 0);
                self.sio.read(self.active, offset, pins)
            }
            0xe => self.read_ppb(address),
            _ => match base {
                // Chip id: RP2040 B2, manufacturer 0x927.
                0x4000_0000 => match offset {
                    0x00 => Some(0x2000_2927),
                    0x04 => Some(2),
                    _ => None,
                },
                0x4000_4000 => match offset {
                    // PROC0_NMI_MASK, PROC1_NMI_MASK, PROC_CONFIG, PROC_IN_SYNC_BYPASS: reset values.
                    0x00..=0x0c => Some(0),
                    _ => None,
                },
                0x4000_8000 => self.clocks.read_clocks(offset),
                0x4000_c000 => match offset {
                    0 => Some(self.resets),
                    4 => Some(self.resets_wdsel),
                    8 => Some(!self.resets & reset::ALL),
                    _ => None,
                },
                0x4001_0000 => match offset {
                    0x0 => Some(0),
                    0x4 => Some(self.psm_off),
                    0x8 => Some(self.psm_wdsel),
                    0xc => Some(0x1_ffff & !self.psm_off),
                    _ => None,
                },
                0x4001_4000 => self.pins.read_io(offset),
                0x4001_c000 => self.pins.read_pads(offset),
                0x4002_4000 => self.clocks.read_xosc(offset),
                0x4002_8000 => self.clocks.read_pll(0, offset),
                0x4002_c000 => self.clocks.read_pll(1, offset),
                0x4003_0000 if offset <= 4 => Some(if offset == 4 { 1 } else { self.storage[0] }),
                0x4003_4000 => self.uart[0].read(offset, now),
                0x4003_8000 => self.uart[1].read(offset, now),
                0x4005_0000 => self.pwm.read(offset, now),
                0x4005_4000 => self.timer.read(offset, now),
                0x4005_8000 => self.watchdog.read(offset, now),
                0x4006_0000 => self.clocks.read_rosc(offset),
                0x4006_4000 => match offset {
                    0x0 => Some(0xb1 | 1 << 12),
                    0x4 => Some(0x91),
                    0x8 => Some(self.chip_reset),
                    _ => None,
                },
                0x5000_0000 => self.dma.read(offset),
                0x5010_0000 => Some(self.usb.word(offset as usize)),
                0x5011_0000 => self.usb.read(offset),
                0x5020_0000 => self.pio[0].read(offset),
                0x5030_0000 => self.pio[1].read(offset),
                _ => None,
            },
        };
        // Reads with side effects (FIFOs) may let DMA or a line move.
        if self.dma.busy != 0 {
            self.dma_at = self.dma_at.min(now + 1);
        }
        self.quiet_until = 0;
        self.lines_dirty = true;
        match value {
            Some(v) => v,
            None => {
                self.not_modelled("read", address);
                0
            }
        }
    }

    fn peripheral_write(&mut self, address: u32, value: u32) {
        let alias = match address >> 28 {
            4 | 5 => address >> 12 & 3,
            _ => 0,
        };
        let plain = if alias == 0 {
            address
        } else {
            address & !0x3000
        };
        let base = plain & 0xffff_c000;
        if self.resets & Self::gate(base) != 0 {
            self.fault.get_or_insert(Fault::HeldInReset {
                access: "write",
                register: Self::register(plain),
                address: plain,
            });
            return;
        }
        let value = match alias {
            0 => value,
            _ => {
                let old = self.peek(plain);
                match alias {
                    1 => old ^ value,
                    2 => old | value,
                    _ => old & !value,
                }
            }
        };
        if !self.write_register(plain, base, value) {
            self.not_modelled("write", plain);
        }
        if self.dma.busy != 0 {
            self.dma_at = self.dma_at.min(self.now + 1);
        }
        self.quiet_until = 0;
        self.lines_dirty = true;
        self.update_lines();
    }

    /// The stored value an atomic alias works on. Registers whose bits are cleared by writing ones read as zero here, so that setting
    /// bits through the alias clears just those.
    fn peek(&mut self, address: u32) -> u32 {
        let base = address & 0xffff_c000;
        let offset = address & 0xfff;
        let write_one_clears = matches!(
            (base, offset),
            (0x5011_0000, 0x50 | 0x58)
                | (0x5020_0000 | 0x5030_0000, 0x008 | 0x030 | 0x034)
                | (0x5000_0000, 0x400 | 0x40c | 0x41c | 0x430 | 0x444)
                | (0x4005_4000, 0x20 | 0x34)
                | (0x4001_4000, 0xf0..=0xfc)
                | (0x4003_4000 | 0x4003_8000, 0x00 | 0x44)
        );
        if write_one_clears {
            return 0;
        }
        self.peripheral_read(address)
    }

    fn write_register(&mut self, address: u32, base: u32, value: u32) -> bool {
        let offset = address & 0xfff;
        let now = self.now;
        match address >> 28 {
            0x1 => return self.write_flash_interface(address, value),
            0xd => {
                return match self.sio.write(self.active, offset, value) {
                    Some(Effect::Pins) => {
                        self.resolve_pins();
                        true
                    }
                    Some(Effect::Pushed) => {
                        self.signal_event();
                        if self.active == 0 {
                            self.core1_launching = true;
                        }
                        true
                    }
                    Some(Effect::None) => true,
                    None => false,
                };
            }
            0xe => return self.write_ppb(address, value),
            _ => {}
        }
        match base {
            0x4000_8000 => {
                let ok = self.clocks.write_clocks(offset, value);
                self.clocks_changed();
                return ok;
            }
            0x4000_c000 => match offset {
                0 => {
                    let newly = value & !self.resets;
                    self.resets = value & reset::ALL;
                    self.apply_resets(newly);
                }
                4 => self.resets_wdsel = value,
                8 => {}
                _ => return false,
            },
            0x4001_0000 => match offset {
                0x0 | 0xc => {}
                0x4 => {
                    if value & (1 << 16) != 0 {
                        self.core1_forced_off = true;
                    }
                    self.psm_off = value & 0x1_ffff;
                }
                0x8 => self.psm_wdsel = value & 0x1_ffff,
                _ => return false,
            },
            0x4001_4000 => {
                let ok = self.pins.write_io(offset, value);
                self.resolve_pins();
                return ok;
            }
            0x4001_c000 => {
                let ok = self.pins.write_pads(offset, value);
                self.resolve_pins();
                return ok;
            }
            0x4002_4000 => {
                let ok = self.clocks.write_xosc(offset, value);
                self.clocks_changed();
                return ok;
            }
            0x4002_8000 | 0x4002_c000 => {
                let which = usize::from(base == 0x4002_c000);
                let ok = self.clocks.write_pll(which, offset, value);
                self.clocks_changed();
                return ok;
            }
            0x4003_0000 if offset == 0 => self.storage[0] = value,
            0x4003_4000 => return self.uart[0].write(offset, value, now),
            0x4003_8000 => return self.uart[1].write(offset, value, now),
            0x4005_0000 => {
                let ok = self.pwm.write(offset, value, now);
                self.apply_trigger_level();
                return ok;
            }
            0x4005_4000 => return self.timer.write(offset, value, now),
            0x4005_8000 => match self.watchdog.write(offset, value, now) {
                Some(fires) => {
                    if fires {
                        self.reset_request = Some(ResetCause::WatchdogForced);
                    }
                    if offset == 0x2c {
                        self.clocks_changed();
                    }
                }
                None => return false,
            },
            0x4006_0000 => return self.clocks.write_rosc(offset, value),
            0x5000_0000 => return self.dma.write(offset, value),
            0x5010_0000 => self.write_dpram(offset as usize, value, 4),
            0x5011_0000 => return self.usb.write(offset, value),
            0x5020_0000 | 0x5030_0000 => {
                let which = usize::from(base == 0x5030_0000);
                self.pins.look_ahead(now);
                let ok = self.pio[which].write(offset, value, now, &mut self.pins);
                self.resolve_pins();
                return ok;
            }
            _ => return false,
        }
        true
    }

    fn write_dpram(&mut self, offset: usize, value: u32, size: usize) {
        let at = offset & (DPRAM - 1);
        self.usb.dpram[at..at + size].copy_from_slice(&value.to_le_bytes()[..size]);
        if !self.usb.dpram_written(at & !3) {
            self.not_modelled("double buffering by write", 0x5010_0000 + at as u32);
        }
    }

    fn peripheral_write_narrow(&mut self, address: u32, value: u32, size: usize) {
        if address & 0xffff_f000 == 0x5010_0000 {
            self.write_dpram((address & 0xfff) as usize, value, size);
            return;
        }
        // Narrow writes reach a peripheral on all byte lanes (datasheet 2.1.4).
        let replicated = match size {
            1 => value * 0x0101_0101,
            _ => value * 0x0001_0001,
        };
        self.peripheral_write(address & !3, replicated);
    }

    fn read_flash_interface(&mut self, address: u32) -> Option<u32> {
        match address >> 24 {
            0x18 => self.flash.read_ssi(address & 0xff),
            0x14 => match address & 0xff {
                // XIP_CTRL reset value: enabled, error on writes to bad regions.
                0x00 => Some(3),
                // FLUSH reads 0 when done; STAT: flush ready, FIFO empty.
                0x04 => Some(0),
                0x08 => Some(3),
                _ => None,
            },
            _ => None,
        }
    }

    fn write_flash_interface(&mut self, address: u32, value: u32) -> bool {
        match address >> 24 {
            0x18 => self.flash.write_ssi(address & 0xff, value),
            0x14 => matches!(address & 0xff, 0x00 | 0x04),
            _ => false,
        }
    }

    // ---- private peripheral bus ----------------------------------------------------------------------------------------------

    fn read_ppb(&self, address: u32) -> Option<u32> {
        let core = self.active;
        let nvic = &self.nvic[core];
        Some(match address & 0xffff {
            0xe100 | 0xe180 => nvic.enabled,
            0xe200 | 0xe280 => nvic.pending,
            0xe400..=0xe41c => {
                let at = (address & 0x1c) as usize;
                u32::from_le_bytes(nvic.priority[at..at + 4].try_into().expect("four bytes"))
            }
            // SYST_CSR, SYST_RVR, SYST_CVR: the timer is off, as no image uses it.
            0xe010..=0xe018 => 0,
            0xed00 | 0xed04 | 0xed08 | 0xed0c | 0xed1c | 0xed20 => self.ppb[core].read32(address),
            0xed10 => 0,
            // CCR: stack aligned to 8, unaligned accesses trap.
            0xed14 => 0x208,
            _ => return None,
        })
    }

    fn write_ppb(&mut self, address: u32, value: u32) -> bool {
        let core = self.active;
        let active = (self.ppb[core].active >> 16) as u32;
        match address & 0xffff {
            0xe100 => self.nvic[core].enabled |= value & 0x03ff_ffff,
            0xe180 => self.nvic[core].enabled &= !value,
            0xe200 => self.nvic[core].pending |= value & 0x03ff_ffff,
            0xe280 => {
                self.nvic[core].pending &= !value;
                // A level that is still up becomes pending again at once.
                self.nvic[core].pending |= self.compute_lines()[core] & !active;
            }
            0xe400..=0xe41c => {
                let at = (address & 0x1c) as usize;
                for (slot, byte) in self.nvic[core].priority[at..at + 4]
                    .iter_mut()
                    .zip(value.to_le_bytes())
                {
                    *slot = byte & 0xc0;
                }
            }
            0xed0c => {
                // AIRCR: the key, then SYSRESETREQ.
                if value >> 16 == 0x05fa && value & 4 != 0 {
                    self.reset_request = Some(ResetCause::Software);
                }
            }
            0xed04 | 0xed08 | 0xed1c | 0xed20 => self.ppb[core].write32(address, value),
            0xed10 if value & !0x10 == 0 => {}
            _ => return false,
        }
        true
    }

    fn signal_event(&mut self) {
        self.event = [true; 2];
        self.event_time = self.core_time.max(self.now);
        for core in 0..2 {
            if self.asleep[core] && self.wfe[core] && self.wake_at[core].is_none() {
                self.wake_at[core] = Some(self.event_time);
            }
        }
    }

    // ---- core accesses that are not memory -----------------------------------------------------------------------------------

    #[inline(never)]
    fn slow_read(&mut self, address: u32) -> u32 {
        match address >> 28 {
            4 | 5 | 0xd | 0xe => {}
            1 if matches!(address >> 24, 0x14 | 0x18) => {}
            _ => {
                self.bus_fault = Some(address);
                return 0;
            }
        }
        self.attention = true;
        self.advance(self.core_time);
        let value = self.peripheral_read(address);
        self.update_lines();
        value
    }

    #[inline(never)]
    fn slow_write(&mut self, address: u32, value: u32, size: usize) {
        match address >> 28 {
            4 | 5 | 0xd | 0xe => {}
            1 if matches!(address >> 24, 0x14 | 0x18) => {}
            _ => {
                self.bus_fault = Some(address);
                return;
            }
        }
        self.attention = true;
        self.advance(self.core_time);
        if size == 4 {
            self.peripheral_write(address, value);
        } else {
            self.peripheral_write_narrow(address, value, size);
        }
    }
}

impl CoreBus for Bus {
    #[inline]
    fn read8(&mut self, address: u32) -> u8 {
        match self.core_memory::<1>(address) {
            Some([byte]) => byte,
            None => (self.slow_read(address & !3) >> (8 * (address & 3))) as u8,
        }
    }

    #[inline]
    fn read16(&mut self, address: u32) -> u16 {
        match self.core_memory(address) {
            Some(bytes) => u16::from_le_bytes(bytes),
            None => (self.slow_read(address & !3) >> (8 * (address & 2))) as u16,
        }
    }

    #[inline]
    fn read32(&mut self, address: u32) -> u32 {
        match self.core_memory(address) {
            Some(bytes) => u32::from_le_bytes(bytes),
            None => self.slow_read(address),
        }
    }

    #[inline]
    fn write8(&mut self, address: u32, value: u8) {
        match self.sram_offset(address, 1) {
            Some(at) => {
                self.sram[at] = value;
                self.note_write(at, address);
            }
            None => self.slow_write(address, u32::from(value), 1),
        }
    }

    #[inline]
    fn write16(&mut self, address: u32, value: u16) {
        match self.sram_offset(address, 2) {
            Some(at) => {
                self.sram[at..at + 2].copy_from_slice(&value.to_le_bytes());
                self.note_write(at, address);
            }
            None => self.slow_write(address, u32::from(value), 2),
        }
    }

    #[inline]
    fn write32(&mut self, address: u32, value: u32) {
        match self.sram_offset(address, 4) {
            Some(at) => {
                self.sram[at..at + 4].copy_from_slice(&value.to_le_bytes());
                self.note_write(at, address);
            }
            None => self.slow_write(address, value, 4),
        }
    }

    #[inline]
    fn set_active_pc(&mut self, pc: u32) {
        self.active_pc = pc;
        if pc >> 28 == 1 && self.active == 1 {
            self.note_core1_xip(pc);
        }
    }

    #[inline]
    fn bus_fault(&self) -> bool {
        self.bus_fault.is_some()
    }

    fn bus_fault_addr(&self) -> u32 {
        self.bus_fault.unwrap_or(0)
    }

    fn clear_bus_fault(&mut self) {
        self.bus_fault = None;
    }

    #[inline]
    fn ppb(&self, core: usize) -> &Ppb {
        &self.ppb[core]
    }

    #[inline]
    fn ppb_mut(&mut self, core: usize) -> &mut Ppb {
        // Exceptions are entered and left through here.
        self.attention = true;
        &mut self.ppb[core]
    }

    #[inline]
    fn nvic(&self, core: usize) -> &Nvic {
        &self.nvic[core]
    }

    #[inline]
    fn nvic_mut(&mut self, core: usize) -> &mut Nvic {
        &mut self.nvic[core]
    }

    #[inline]
    fn active_core(&self) -> usize {
        self.active
    }

    fn event_flag(&self, core: usize) -> bool {
        self.event[core]
    }

    fn consume_event_flag(&mut self, core: usize) -> bool {
        std::mem::replace(&mut self.event[core], false)
    }

    fn set_wfe_waiting(&mut self, core: usize, waiting: bool) {
        self.wfe[core] = waiting;
        self.attention = true;
    }

    fn signal_sev(&mut self) {
        if (self.active_pc as usize) < ROM {
            self.rom_called = true;
            self.attention = true;
            return;
        }
        self.signal_event();
    }
}
