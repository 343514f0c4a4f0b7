//! The function table: which GPIO carries which signal of which peripheral.
//!
//! Source: RP2040 datasheet 2.19.2, table 279 (function select). Every column repeats along the bank, so each is a formula:
//!
//! | F | function | GPIO n carries |
//! |---|---|---|
//! | 1 | SPI | n mod 4: RX, CSn, SCK, TX of SPI (n / 8) mod 2 |
//! | 2 | UART | n mod 4: TX, RX, CTS, RTS of UART ((n + 4) / 8) mod 2 |
//! | 3 | I2C | n mod 2: SDA, SCL of I2C (n / 2) mod 2 |
//! | 4 | PWM | n mod 2: A, B of slice (n / 2) mod 8 |
//! | 5 | SIO | itself |
//! | 6 7 | PIO0 PIO1 | itself |
//! | 8 | CLOCK | GPIN0 20, GPOUT0 21, GPIN1 22, GPOUT1-3 23-25 |
//! | 9 | USB | n mod 3: OVCUR_DET, VBUS_DET, VBUS_EN |

use super::PADS;

pub const SPI: usize = 1;
pub const UART: usize = 2;
pub const I2C: usize = 3;
pub const PWM: usize = 4;
pub const SIO: usize = 5;
pub const PIO0: usize = 6;
pub const PIO1: usize = 7;
pub const CLOCK: usize = 8;
/// Function codes that select something; 31 selects nothing.
pub const FUNCTIONS: usize = 10;

/// Signals in the order of the pins that carry them.
pub mod spi {
    pub const RX: usize = 0;
    pub const CSN: usize = 1;
    pub const SCK: usize = 2;
    pub const TX: usize = 3;
}

/// Signals in the order of the pins that carry them.
pub mod uart {
    pub const TX: usize = 0;
    pub const RX: usize = 1;
    pub const CTS: usize = 2;
    pub const RTS: usize = 3;
}

/// Signals in the order of the pins that carry them.
pub mod i2c {
    pub const SDA: usize = 0;
    pub const SCL: usize = 1;
}

/// Pins that can carry a signal of UART `instance`.
pub const fn uart_pins(instance: usize, signal: usize) -> u32 {
    let mut mask = 0;
    let mut n = 0;
    while n < PADS {
        if n % 4 == signal && (n + 4) / 8 % 2 == instance {
            mask |= 1 << n;
        }
        n += 1;
    }
    mask
}

/// Pins that can carry a signal of SPI `instance`.
pub const fn spi_pins(instance: usize, signal: usize) -> u32 {
    let mut mask = 0;
    let mut n = 0;
    while n < PADS {
        if n % 4 == signal && n / 8 % 2 == instance {
            mask |= 1 << n;
        }
        n += 1;
    }
    mask
}

/// Pins that can carry a signal of I2C `instance`.
pub const fn i2c_pins(instance: usize, signal: usize) -> u32 {
    let mut mask = 0;
    let mut n = 0;
    while n < PADS {
        if n % 2 == signal && n / 2 % 2 == instance {
            mask |= 1 << n;
        }
        n += 1;
    }
    mask
}

/// Pins that can carry output or input `channel` (A 0, B 1) of PWM `slice`.
pub const fn pwm_pins(slice: usize, channel: usize) -> u32 {
    let mut mask = 0;
    let mut n = 0;
    while n < PADS {
        if n % 2 == channel && n / 2 % 8 == slice {
            mask |= 1 << n;
        }
        n += 1;
    }
    mask
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn pins<const N: usize>(list: [usize; N]) -> u32 {
        let mut mask = 0;
        let mut i = 0;
        while i < N {
            mask |= 1 << list[i];
            i += 1;
        }
        mask
    }

    #[test]
    fn the_formulas_are_table_279() {
        assert_eq!(uart_pins(0, uart::TX), pins([0, 12, 16, 28]));
        assert_eq!(uart_pins(0, uart::RX), pins([1, 13, 17, 29]));
        assert_eq!(uart_pins(1, uart::TX), pins([4, 8, 20, 24]));
        assert_eq!(uart_pins(1, uart::CTS), pins([6, 10, 22, 26]));
        assert_eq!(spi_pins(0, spi::RX), pins([0, 4, 16, 20]));
        assert_eq!(spi_pins(1, spi::TX), pins([11, 15, 27]));
        assert_eq!(spi_pins(1, spi::SCK), pins([10, 14, 26]));
        assert_eq!(spi_pins(0, spi::CSN), pins([1, 5, 17, 21]));
        assert_eq!(i2c_pins(0, i2c::SDA), pins([0, 4, 8, 12, 16, 20, 24, 28]));
        assert_eq!(i2c_pins(1, i2c::SCL), pins([3, 7, 11, 15, 19, 23, 27]));
        assert_eq!(pwm_pins(4, 1), pins([9, 25]));
        assert_eq!(pwm_pins(7, 0), pins([14]));
    }
}
