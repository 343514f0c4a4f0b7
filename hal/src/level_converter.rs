//! The ADC, running freely on RSSI into its FIFO; and now and then for a moment on a trigger level.
//!
//! ```text
//!   48 MHz, a conversion of 96 cycles every 109: 2.271 us = 272.5 system cycles, no whole number of microseconds
//!   FIFO ─▶ DMA ring (dma_ring)
//!   read(channel): AINSEL away ─ 3 conversions ─ RESULT ─ AINSEL back      what fell into the ring meanwhile is no level
//! ```
//! Source: RP2040 datasheet, 4.9.

use rp2040_hal::pac;

/// ADC channel of RSSI: GPIO 28.
const RSSI: u8 = 2;
/// Cycles of 48 MHz between two conversions.
const CYCLES: u16 = 109;
/// Time for two whole conversions of a channel, us: the one under way, and the one read.
const AWAY_US: u32 = 8;

/// The converter.
pub struct LevelConverter {
    adc: pac::ADC,
}

impl LevelConverter {
    /// Powers it up, stopped. The ADC must be out of reset and clk_adc run at 48 MHz.
    pub(crate) fn new(adc: pac::ADC) -> Self {
        adc.cs().write(|w| w.en().set_bit());
        while adc.cs().read().ready().bit_is_clear() {}
        // SAFETY: a divider of CYCLES - 1 and a FIFO threshold of one are valid.
        unsafe {
            adc.div().write(|w| w.int().bits(CYCLES - 1).frac().bits(0));
            adc.fcs()
                .write(|w| w.en().set_bit().dreq_en().set_bit().thresh().bits(1));
        }
        Self { adc }
    }

    /// Starts converting RSSI.
    #[inline(always)]
    pub(crate) fn start(&mut self) {
        // SAFETY: RSSI is a channel.
        self.adc
            .cs()
            .write(|w| unsafe { w.ainsel().bits(RSSI).en().set_bit().start_many().set_bit() });
    }

    /// One conversion of another channel (0 to 2), 12 bits; takes some microseconds, in which no level is measured.
    pub fn read(&mut self, channel: u8) -> u16 {
        // SAFETY: three bits.
        self.adc
            .cs()
            .modify(|_, w| unsafe { w.ainsel().bits(channel & 7) });
        let start = crate::timer::now_us_low();
        while crate::timer::now_us_low().wrapping_sub(start) < AWAY_US {}
        let code = self.adc.result().read().bits() as u16 & 0xFFF;
        // SAFETY: RSSI is a channel.
        self.adc
            .cs()
            .modify(|_, w| unsafe { w.ainsel().bits(RSSI) });
        code
    }
}
