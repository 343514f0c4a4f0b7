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

/// Pins n with n mod `every` = `signal` and (n + `shift`) / `group` mod `instances` = `instance`.
const fn column(
    (every, signal): (usize, usize),
    (shift, group): (usize, usize),
    (instances, instance): (usize, usize),
) -> u32 {
    let mut mask = 0;
    let mut n = 0;
    while n < PADS {
        if n % every == signal && (n + shift) / group % instances == instance {
            mask |= 1 << n;
        }
        n += 1;
    }
    mask
}

/// One row an instance, one mask a signal.
const fn table<const SIGNALS: usize, const INSTANCES: usize>(
    shift: usize,
    group: usize,
) -> [[u32; SIGNALS]; INSTANCES] {
    let mut table = [[0; SIGNALS]; INSTANCES];
    let mut instance = 0;
    while instance < INSTANCES {
        let mut signal = 0;
        while signal < SIGNALS {
            let row = (INSTANCES, instance);
            table[instance][signal] = column((SIGNALS, signal), (shift, group), row);
            signal += 1;
        }
        instance += 1;
    }
    table
}

/// Pins that can carry a signal of a UART: `UART_PINS[instance][signal]`.
pub const UART_PINS: [[u32; 4]; 2] = table(4, 8);
/// The same for SPI.
pub const SPI_PINS: [[u32; 4]; 2] = table(0, 8);
/// The same for I2C.
pub const I2C_PINS: [[u32; 2]; 2] = table(0, 2);
/// Pins of PWM slices, A and B.
pub const PWM_PINS: [[u32; 2]; 8] = table(0, 2);

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
        assert_eq!(UART_PINS[0][uart::TX], pins([0, 12, 16, 28]));
        assert_eq!(UART_PINS[0][uart::RX], pins([1, 13, 17, 29]));
        assert_eq!(UART_PINS[1][uart::TX], pins([4, 8, 20, 24]));
        assert_eq!(UART_PINS[1][uart::CTS], pins([6, 10, 22, 26]));
        assert_eq!(SPI_PINS[0][spi::RX], pins([0, 4, 16, 20]));
        assert_eq!(SPI_PINS[1][spi::TX], pins([11, 15, 27]));
        assert_eq!(SPI_PINS[1][spi::SCK], pins([10, 14, 26]));
        assert_eq!(SPI_PINS[0][spi::CSN], pins([1, 5, 17, 21]));
        assert_eq!(I2C_PINS[0][i2c::SDA], pins([0, 4, 8, 12, 16, 20, 24, 28]));
        assert_eq!(I2C_PINS[1][i2c::SCL], pins([3, 7, 11, 15, 19, 23, 27]));
        assert_eq!(PWM_PINS[4][1], pins([9, 25]));
        assert_eq!(PWM_PINS[7][0], pins([14]));
    }
}
