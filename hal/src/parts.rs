//! Everything brought up once, in the order the chip wants it.
//!
//! ```text
//!   crystal ─ PLL_SYS 120 MHz, PLL_USB 48 MHz ─ clk_sys, clk_peri = PLL_SYS; clk_usb = PLL_USB; clk_ref = crystal
//!   watchdog tick 1 MHz ─ TIMER, DMA, PIO0, UART0, UART1, PWM out of reset ─ pins by net name ─ ports
//! ```

use crate::board::{self, GNSS_PPS_GPIO, PULSES_GPIO, TriggerLevelLowPwm, TriggerLevelPwm};
use crate::core1::Core1;
use crate::dma_ring::DmaChannels;
use crate::flash::{self, Flash, UNIQUE_ID};
use crate::i2c::I2c1;
use crate::level_converter::LevelConverter;
use crate::pio_sampler::PioSampler;
use crate::pps_counter::PpsCounter;
use crate::uart::{CommsUart, GnssUart};
use crate::usb::UsbConsole;
use crate::watchdog::Watchdog;
use rp2040_hal::clocks::{ClocksManager, UsbClock};
use rp2040_hal::fugit::HertzU32;
use rp2040_hal::pll::{PLLConfig, common_configs::PLL_USB_48MHZ, setup_pll_blocking};
use rp2040_hal::pwm::Slices;
use rp2040_hal::usb::UsbBus;
use rp2040_hal::{Sio, gpio, pac, xosc::setup_xosc_blocking};

/// COMMS_UART's rate before any setting, bits a second.
pub const COMMS_BAUD: u32 = 115_200;

/// Flash that every board has (a bare Pico's 2 MiB; larger parts are not used beyond that), bytes.
const FLASH_BYTES: u32 = 2 * 1024 * 1024;

/// VCO 1200 MHz / 5 / 2 = 120 MHz.
const PLL_SYS_120MHZ: PLLConfig = PLLConfig {
    vco_freq: HertzU32::MHz(1200),
    refdiv: 1,
    post_div1: 5,
    post_div2: 2,
};

/// Counts a period of the trigger level's PWM: 120 MHz / 5000 = 24 kHz.
pub const TRIGGER_LEVEL_PERIOD: u16 = 5000;

/// USB before the host sees it.
pub struct UsbParts {
    bus: UsbBus,
    unique_id: [u8; UNIQUE_ID],
}

impl UsbParts {
    /// Shows the device to the host.
    pub fn attach(self) -> Option<UsbConsole> {
        UsbConsole::new(self.bus, self.unique_id)
    }
}

/// The GNSS receiver's wires before anybody listens.
pub struct GnssParts {
    uart: pac::UART0,
    pps_gpio: u8,
}

impl GnssParts {
    /// Starts its UART, and sets its pulse's counters up, which start with the sampler: this comes before it.
    pub fn start(self, baud: u32) -> (GnssUart, PpsCounter) {
        (
            GnssUart::gnss(self.uart, baud),
            PpsCounter::new(self.pps_gpio),
        )
    }
}

/// What the chip and the board offer, each once.
pub struct Parts {
    /// Pins by net name that a driver takes; the rest are wired already.
    pub led: board::Led,
    /// BOOT/CONFIG pin.
    pub boot_config: board::BootConfig,
    /// Trigger level PWM, running at duty 0.
    pub trigger_level: TriggerLevelPwm,
    /// The second level's, on boards that have one.
    pub trigger_level_low: Option<TriggerLevelLowPwm>,
    /// Bias tee, off.
    pub bias_tee: Option<board::BiasTee>,
    /// The ESP32's supply, off.
    pub esp32_enable: Option<board::Esp32Enable>,
    /// The bus of EEPROM and potentiometer.
    pub i2c: Option<I2c1>,
    /// PULSES sampler, stopped.
    pub sampler: PioSampler,
    /// The converter, stopped.
    pub converter: LevelConverter,
    /// DMA channels for the rings.
    pub dma: DmaChannels,
    /// The GNSS receiver's UART and pulse, not started, on boards that have a connector for one.
    pub gnss: Option<GnssParts>,
    /// COMMS_UART, running at [`COMMS_BAUD`].
    pub comms_uart: CommsUart,
    /// USB, not yet shown to the host.
    pub usb: UsbParts,
    /// The flash of the smallest board, 2 MiB.
    pub flash: Flash,
    /// The same, for whoever keeps the settings in it: each keeps to its own area.
    pub settings_flash: Flash,
    /// The flash part's unique id: the device's serial number.
    pub unique_id: [u8; UNIQUE_ID],
    /// The watchdog, not started.
    pub watchdog: Watchdog,
    /// The second core, in its ROM.
    pub core1: Core1,
}

impl Parts {
    /// Brings chip and board up. `None` the second time, or for clocks that the chip cannot make. A crystal that does not start or a
    /// PLL that does not lock is waited for without end: the watchdog decides, if it runs already.
    pub fn take() -> Option<Self> {
        let p = pac::Peripherals::take()?;
        let mut resets = p.RESETS;
        let mut watchdog = rp2040_hal::Watchdog::new(p.WATCHDOG);
        watchdog.enable_tick_generation((crate::CRYSTAL_HZ / 1_000_000) as u8);

        let xosc = setup_xosc_blocking(p.XOSC, HertzU32::Hz(crate::CRYSTAL_HZ)).ok()?;
        let mut clocks = ClocksManager::new(p.CLOCKS);
        let pll_sys = setup_pll_blocking(
            p.PLL_SYS,
            xosc.operating_frequency(),
            PLL_SYS_120MHZ,
            &mut clocks,
            &mut resets,
        )
        .ok()?;
        let pll_usb = setup_pll_blocking(
            p.PLL_USB,
            xosc.operating_frequency(),
            PLL_USB_48MHZ,
            &mut clocks,
            &mut resets,
        )
        .ok()?;
        clocks.init_default(&xosc, &pll_sys, &pll_usb).ok()?;

        resets.reset().modify(|_, w| {
            w.timer()
                .clear_bit()
                .dma()
                .clear_bit()
                .pio0()
                .clear_bit()
                .uart0()
                .clear_bit()
                .adc()
                .clear_bit()
                .uart1()
                .clear_bit()
        });
        while {
            let done = resets.reset_done().read();
            done.timer().bit_is_clear()
                || done.dma().bit_is_clear()
                || done.pio0().bit_is_clear()
                || done.uart0().bit_is_clear()
                || done.adc().bit_is_clear()
                || done.uart1().bit_is_clear()
        } {}

        let unique_id = flash::unique_id();
        let sio = Sio::new(p.SIO);
        let pins = board::pins(gpio::Pins::new(
            p.IO_BANK0,
            p.PADS_BANK0,
            sio.gpio_bank0,
            &mut resets,
        ));
        let slices = Slices::new(p.PWM, &mut resets);
        let (trigger_level, trigger_level_low) =
            board::trigger_levels(slices, TRIGGER_LEVEL_PERIOD);
        let usb_clock: UsbClock = clocks.usb_clock;
        let bus = UsbBus::new(
            p.USBCTRL_REGS,
            p.USBCTRL_DPRAM,
            usb_clock,
            true,
            &mut resets,
        );

        Some(Self {
            led: pins.led,
            boot_config: pins.boot_config,
            trigger_level,
            trigger_level_low,
            bias_tee: pins.bias_tee,
            esp32_enable: pins.esp32_enable,
            i2c: pins.i2c.map(|_| I2c1::new(p.I2C1)),
            sampler: PioSampler::new(p.PIO0, PULSES_GPIO),
            converter: LevelConverter::new(p.ADC),
            dma: DmaChannels { dma: p.DMA },
            gnss: GNSS_PPS_GPIO.map(|pps_gpio| GnssParts {
                uart: p.UART0,
                pps_gpio,
            }),
            comms_uart: CommsUart::comms(p.UART1, COMMS_BAUD),
            usb: UsbParts { bus, unique_id },
            flash: Flash::new(FLASH_BYTES),
            settings_flash: Flash::new(FLASH_BYTES),
            unique_id,
            watchdog: Watchdog::new(watchdog),
            core1: Core1 {
                psm: p.PSM,
                fifo: sio.fifo,
            },
        })
    }
}
