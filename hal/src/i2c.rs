//! I2C1, 400 kHz, as controller: every wait has an end.
//!
//! ```text
//!   lines free? ─ no ─▶ recover: block reset, nine SCL pulses, STOP ─ still held ─▶ error: which line
//!      │ yes                                                        └ free ─▶ once more
//!      ▼
//!   address, commands into the FIFO of 16, bytes out of it, until STOP ─▶ done; not acknowledged: error; no end in time, bus lost: recover
//! ```
//! Written anew beside `rp2040-hal`'s, because that one waits for the FIFO without end when SCL is held, and calls a write that fits into the FIFO
//! done before its bytes were acknowledged. Here a transfer is done when its STOP was seen and nothing was refused.
//!
//! When core 0 is late the controller holds SCL low between bytes: nothing is lost. A transfer of 34 bytes takes 0.8 ms, in which core 0 waits.
//!
//! Source: RP2040 datasheet 4.3 (DW_apb_i2c; 4.3.14 timing); I2C specification UM10204 3.1.16 (bus clear), table 10 (fast mode).

use embedded_hal::i2c::{self, NoAcknowledgeSource, Operation, SevenBitAddress};
use rp2040_hal::pac;

use crate::timer;

/// Rate of fast mode, Hz.
const BUS_HZ: u32 = 400_000;
/// Cycles of clk_sys a bit: 300; three fifths low, two fifths high, as in Raspberry Pi's SDK (low at least 1.3 us, high 0.6 us: UM10204, table 10).
const BIT_CYCLES: u32 = crate::SYSTEM_HZ / BUS_HZ;
const LOW_CYCLES: u32 = BIT_CYCLES * 3 / 5;
const HIGH_CYCLES: u32 = BIT_CYCLES - LOW_CYCLES;
/// Spikes up to 50 ns are no edges (UM10204, table 10: tSP): 6 cycles.
const SPIKE_CYCLES: u32 = crate::SYSTEM_HZ / 20_000_000;
/// SDA stays this long after SCL's fall: 300 ns bridge the undefined part of the edge (UM10204, table 10, note 3).
const HOLD_CYCLES: u32 = crate::SYSTEM_HZ / 1_000_000 * 3 / 10 + 1;
/// Depth of each FIFO (datasheet 4.3.2).
const FIFO: usize = 16;
/// The longest that a transfer may take: this and [`BYTE_US`] a byte. A byte takes 23 us where nobody stretches.
const TRANSFER_US: u32 = 500;
const BYTE_US: u32 = 60;
/// Half a period of the pulses that free the bus: 100 kHz, which every device follows. Microseconds.
const PULSE_US: u32 = 5;
/// Pulses after which a device that still sends has sent its byte and sees no acknowledgement (UM10204, 3.1.16).
const PULSES: usize = 9;

/// GPIOs of the bus on every board that has one.
const SDA: usize = 2;
const SCL: usize = 3;
/// Function of a pin that I2C drives, and of one that software does (datasheet, table 279).
const BY_I2C: u8 = 3;
const BY_SIO: u8 = 5;

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// No device answered to the address.
    NoDevice,
    /// A device did not acknowledge a byte.
    Refused,
    /// Somebody holds SDA low, and nine pulses did not change it.
    DataStuck,
    /// Somebody holds SCL low.
    ClockStuck,
    /// The transfer did not end in time, or another controller won the bus; twice.
    NoEnd,
    /// A transfer without bytes, which this controller cannot make.
    Empty,
}

impl i2c::Error for Error {
    fn kind(&self) -> i2c::ErrorKind {
        match self {
            Error::NoDevice => i2c::ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Error::Refused => i2c::ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data),
            Error::DataStuck | Error::ClockStuck => i2c::ErrorKind::Bus,
            Error::NoEnd | Error::Empty => i2c::ErrorKind::Other,
        }
    }
}

/// What happened on the bus since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Transfers asked for.
    pub transfers: u32,
    /// Of these not acknowledged: a device that is absent, or busy with a write.
    pub refused: u32,
    /// Of these failed otherwise.
    pub failed: u32,
    /// Times the bus was freed by pulses, with success or without.
    pub recoveries: u32,
}

/// The controller.
pub struct I2c1 {
    registers: pac::I2C1,
    pub counters: Counters,
}

impl I2c1 {
    /// Starts it. Its pins have been given function, pull-ups and input by the board file.
    pub(crate) fn new(registers: pac::I2C1) -> Self {
        let mut i2c = Self {
            registers,
            counters: Counters::default(),
        };
        i2c.restart();
        i2c
    }

    /// Resets the block and sets it up: whatever it was doing is over.
    fn restart(&mut self) {
        // SAFETY: RESETS is touched by core 0 alone, at start-up and here, never by an interrupt handler.
        let resets = unsafe { &*pac::RESETS::ptr() };
        resets.reset().modify(|_, w| w.i2c1().set_bit());
        resets.reset().modify(|_, w| w.i2c1().clear_bit());
        while resets.reset_done().read().i2c1().bit_is_clear() {}
        let r = &self.registers;
        r.ic_con().write(|w| {
            w.master_mode().enabled().speed().fast();
            w.ic_restart_en()
                .enabled()
                .ic_slave_disable()
                .slave_disabled();
            w.rx_fifo_full_hld_ctrl().enabled()
        });
        // SAFETY: counts within the ranges of the datasheet, 4.3.14: HCNT at least 6, LCNT at least 8, SPKLEN at least 1, hold below LCNT - 2.
        unsafe {
            // The controller adds seven cycles and the spike filter's to the high time, one to the low time.
            r.ic_fs_scl_hcnt()
                .write(|w| w.bits(HIGH_CYCLES - SPIKE_CYCLES - 7));
            r.ic_fs_scl_lcnt().write(|w| w.bits(LOW_CYCLES - 1));
            r.ic_fs_spklen().write(|w| w.bits(SPIKE_CYCLES));
            r.ic_sda_hold().write(|w| w.bits(HOLD_CYCLES));
        }
    }

    /// A transfer, with recovery and one more try where the bus is held or lost.
    fn perform(&mut self, address: u8, operations: &mut [Operation]) -> Result<(), Error> {
        self.counters.transfers = self.counters.transfers.wrapping_add(1);
        let mut result = match lines() {
            (true, true) => self.transfer(address, operations),
            _ => Err(Error::NoEnd),
        };
        if result == Err(Error::NoEnd) {
            result = self
                .recover()
                .and_then(|()| self.transfer(address, operations));
        }
        match result {
            Ok(()) => {}
            Err(Error::NoDevice | Error::Refused) => {
                self.counters.refused = self.counters.refused.wrapping_add(1);
            }
            Err(_) => self.counters.failed = self.counters.failed.wrapping_add(1),
        }
        result
    }

    /// One try.
    fn transfer(&mut self, address: u8, operations: &mut [Operation]) -> Result<(), Error> {
        let (bytes, to_read) = count(operations);
        if bytes == 0 {
            return Err(Error::Empty);
        }
        let r = &self.registers;
        r.ic_enable().write(|w| w.enable().disabled());
        // SAFETY: an address of seven bits.
        r.ic_tar()
            .write(|w| unsafe { w.ic_tar().bits(u16::from(address & 0x7f)) });
        r.ic_enable().write(|w| w.enable().enabled());
        r.ic_clr_intr().read();

        let start = timer::now_us_low();
        let longest_us = TRANSFER_US + BYTE_US * bytes as u32;
        let (mut out, mut into) = (Cursor::default(), Cursor::default());
        let (mut sent, mut asked, mut got) = (0, 0, 0);
        loop {
            let raised = r.ic_raw_intr_stat().read();
            if raised.tx_abrt().bit_is_set() {
                return Err(self.refusal(start, longest_us));
            }
            while got < asked && r.ic_rxflr().read().bits() > 0 {
                let byte = r.ic_data_cmd().read().dat().bits();
                into.put(operations, byte);
                got += 1;
            }
            while sent < bytes && asked - got < FIFO && (r.ic_txflr().read().bits() as usize) < FIFO
            {
                let (byte, reads, restart) = out.next(operations);
                sent += 1;
                asked += usize::from(reads);
                // SAFETY: data, and the three command bits of the register.
                r.ic_data_cmd().write(|w| unsafe {
                    w.dat().bits(byte);
                    w.cmd().bit(reads).restart().bit(restart);
                    w.stop().bit(sent == bytes)
                });
            }
            if sent == bytes && got == to_read && raised.stop_det().bit_is_set() {
                return Ok(());
            }
            if timer::now_us_low().wrapping_sub(start) > longest_us {
                return Err(Error::NoEnd);
            }
        }
    }

    /// What the controller says of a transfer it gave up; waits for its STOP.
    fn refusal(&mut self, start: u32, longest_us: u32) -> Error {
        let r = &self.registers;
        let source = r.ic_tx_abrt_source().read();
        let error = if source.abrt_7b_addr_noack().bit_is_set() {
            Error::NoDevice
        } else if source.abrt_txdata_noack().bit_is_set() {
            Error::Refused
        } else {
            return Error::NoEnd;
        };
        r.ic_clr_tx_abrt().read();
        while r.ic_status().read().mst_activity().bit_is_set() {
            if timer::now_us_low().wrapping_sub(start) > longest_us {
                return Error::NoEnd;
            }
        }
        error
    }

    /// Frees the bus: block reset, nine pulses, STOP.
    fn recover(&mut self) -> Result<(), Error> {
        self.counters.recoveries = self.counters.recoveries.wrapping_add(1);
        by_software(true);
        wait();
        let clock_held = !lines().1;
        if !clock_held {
            for _ in 0..PULSES {
                pull(SCL, true);
                wait();
                pull(SCL, false);
                wait();
            }
            // STOP: SDA rises while SCL is high.
            for (line, low) in [(SCL, true), (SDA, true), (SCL, false), (SDA, false)] {
                pull(line, low);
                wait();
            }
        }
        self.restart();
        by_software(false);
        match lines() {
            _ if clock_held => Err(Error::ClockStuck),
            (_, false) => Err(Error::ClockStuck),
            (false, true) => Err(Error::DataStuck),
            (true, true) => Ok(()),
        }
    }
}

impl i2c::ErrorType for I2c1 {
    type Error = Error;
}

impl i2c::I2c<SevenBitAddress> for I2c1 {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        self.perform(address, operations)
    }
}

/// Bytes of a transfer in all, and those to be read.
fn count(operations: &[Operation]) -> (usize, usize) {
    operations
        .iter()
        .fold((0, 0), |(all, to_read), operation| match operation {
            Operation::Read(bytes) => (all + bytes.len(), to_read + bytes.len()),
            Operation::Write(bytes) => (all + bytes.len(), to_read),
        })
}

/// A place in a list of operations.
#[derive(Default)]
struct Cursor {
    operation: usize,
    byte: usize,
    /// Direction of the byte before; `None` before the first.
    reads: Option<bool>,
}

impl Cursor {
    /// The next byte to send (0 for one to read), whether it is one to read, and whether a repeated START stands before it.
    fn next(&mut self, operations: &[Operation]) -> (u8, bool, bool) {
        loop {
            let (byte, reads) = match operations.get(self.operation) {
                Some(Operation::Write(bytes)) => (bytes.get(self.byte), false),
                Some(Operation::Read(bytes)) => (bytes.get(self.byte).map(|_| &0), true),
                None => return (0, false, false),
            };
            let Some(&byte) = byte else {
                self.operation += 1;
                self.byte = 0;
                continue;
            };
            self.byte += 1;
            let before = self.reads.replace(reads);
            return (byte, reads, before.is_some_and(|before| before != reads));
        }
    }

    /// Stores a byte that was read.
    fn put(&mut self, operations: &mut [Operation], byte: u8) {
        while let Some(operation) = operations.get_mut(self.operation) {
            if let Operation::Read(bytes) = operation
                && let Some(place) = bytes.get_mut(self.byte)
            {
                *place = byte;
                self.byte += 1;
                return;
            }
            self.operation += 1;
            self.byte = 0;
        }
    }
}

/// The lines' levels: SDA, SCL.
fn lines() -> (bool, bool) {
    // SAFETY: a read of the pins without side effects.
    let levels = unsafe { (*pac::SIO::ptr()).gpio_in().read().bits() };
    (levels & 1 << SDA != 0, levels & 1 << SCL != 0)
}

/// Software pulls a line low, or lets go of it. Only while the pins are software's.
fn pull(line: usize, low: bool) {
    // SAFETY: these registers change the bits that are set in what is written, and no other pin's.
    unsafe {
        let sio = &*pac::SIO::ptr();
        if low {
            sio.gpio_oe_set().write(|w| w.bits(1 << line));
        } else {
            sio.gpio_oe_clr().write(|w| w.bits(1 << line));
        }
    }
}

/// Gives the pins to software, both let go, or back to the controller.
fn by_software(software: bool) {
    pull(SDA, false);
    pull(SCL, false);
    // SAFETY: as in `pull`; the pins' functions belong to this module once the board file has set them.
    unsafe {
        (*pac::SIO::ptr())
            .gpio_out_clr()
            .write(|w| w.bits(1 << SDA | 1 << SCL));
        let pins = &*pac::IO_BANK0::ptr();
        for pin in [SDA, SCL] {
            let function = if software { BY_SIO } else { BY_I2C };
            pins.gpio(pin)
                .gpio_ctrl()
                .modify(|_, w| w.funcsel().bits(function));
        }
    }
}

/// Half a period of the pulses.
fn wait() {
    let start = timer::now_us_low();
    while timer::now_us_low().wrapping_sub(start) <= PULSE_US {}
}
