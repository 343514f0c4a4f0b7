//! DMA transfers: the bus makes them, since it owns the memories.
//!
//! The DMA reaches memories, XIP and the peripherals of both bridges; SIO and the cores' private peripherals answer it with a bus error
//! (datasheet 2.1), as do writes to ROM and flash.

use super::fabric::{APB_PORT, FAST_PORT};
use super::xip::DMA_MASTER;
use super::{Bus, sram_port};
use crate::chip::dma::{BusError, Request, pacing};

/// A channel's registers: its base and its control word.
const CHANNEL_0: u32 = 0x5000_0000;
const STRIDE: u32 = 0x40;
const WRITE_ADDR: u32 = 0x4;
const CTRL: u32 = 0xc;

impl Bus {
    /// What the source of a DREQ says (datasheet 2.5.3.1); `None` if nothing models it.
    fn request(&self, number: u32) -> Option<Request> {
        let n = number as usize;
        Some(match number {
            0..=3 => self.pio[0].tx_request(n),
            4..=7 => self.pio[0].rx_request(n - 4),
            8..=11 => self.pio[1].tx_request(n - 8),
            12..=15 => self.pio[1].rx_request(n - 12),
            16 | 18 => Request::Ready(self.spi[(n - 16) / 2].tx_ready()),
            17 | 19 => Request::Ready(self.spi[(n - 16) / 2].rx_ready()),
            20 => Request::Ready(self.uart[0].tx_ready()),
            21 => Request::Ready(self.uart[0].rx_ready()),
            22 => Request::Ready(self.uart[1].tx_ready()),
            23 => Request::Ready(self.uart[1].rx_ready()),
            24..=31 => Request::Pulses(self.pwm.wraps(n - 24)),
            32 | 34 => Request::Ready(self.i2c[(n - 32) / 2].tx_ready()),
            33 | 35 => Request::Ready(self.i2c[(n - 32) / 2].rx_ready()),
            36 => Request::Ready(self.adc.ready()),
            pacing::PERMANENT => Request::Always,
            _ => return self.dma.timer_request(number, self.now),
        })
    }

    /// Busy channels take their credits; one that nothing paces stops the chip.
    fn pace_channels(&mut self) {
        let mut rest = self.dma.busy;
        while rest != 0 {
            let n = rest.trailing_zeros();
            rest &= rest - 1;
            match self.request(self.dma.channels[n as usize].dreq()) {
                Some(request) => self.dma.channels[n as usize].take(request),
                None => self.not_modelled("TREQ_SEL", CHANNEL_0 + STRIDE * n + CTRL),
            }
        }
    }

    /// No channel has a transfer for so long from now on.
    pub fn starve_dma(&mut self, us: u64) {
        self.dma_free = self.now + us * self.sys_hz / 1_000_000;
    }

    /// One transfer, and the cycle of the next.
    pub(super) fn move_data(&mut self) {
        if self.now < self.dma_free {
            self.dma_at = self.dma_free;
            return;
        }
        self.pace_channels();
        let Some(n) = self.dma.pick() else {
            // Nothing is ready: the next transfer follows the next event that makes a DREQ.
            self.dma_at = self.dma.next_pulse(self.now);
            return;
        };
        let c = self.dma.channels[n];
        let wait = self
            .dma_waits(c.read_addr, false)
            .max(self.dma_waits(c.write_addr, true));
        match self.transfer(n) {
            Ok(()) => self.dma.transferred(n),
            Err(error) => self.dma.failed(n, error),
        }
        self.dma_free = self.now + 1 + wait;
        self.dma_at = self.dma_free;
    }

    /// Channel `n` reads and writes once.
    fn transfer(&mut self, n: usize) -> Result<(), BusError> {
        let c = self.dma.channels[n];
        let (from, to, size) = (c.read_addr, c.write_addr, c.size());
        for (register, address) in [(0, from), (WRITE_ADDR, to)] {
            if address % size != 0 {
                let register = CHANNEL_0 + STRIDE * n as u32 + register;
                self.not_modelled("an address that is not aligned in use", register);
            }
        }
        let word = self.read_for_dma(from).ok_or(BusError::Read)?;
        // The lanes of the address, then BSWAP, then the sniffer (datasheet 2.5.5.2).
        let unused = 32 - 8 * size;
        let data = word >> (8 * (from % 4)) << unused >> unused;
        let data = match c.byte_swap() {
            true => data.swap_bytes() >> unused,
            false => data,
        };
        self.dma.sniff(n, data);
        self.write_for_dma(to, data, size as usize)
            .ok_or(BusError::Write)
    }

    /// Whether a peripheral of either bridge, or the flash interface, lies at an address.
    fn dma_reaches(address: u32) -> bool {
        matches!(address >> 24, 0x14 | 0x18 | 0x40 | 0x50)
    }

    fn read_for_dma(&mut self, address: u32) -> Option<u32> {
        let address = address & !3;
        match self.memory(address, 4) {
            Some(bytes) => bytes.try_into().ok().map(u32::from_le_bytes),
            None => Self::dma_reaches(address).then(|| self.peripheral_read(address)),
        }
    }

    fn write_for_dma(&mut self, address: u32, value: u32, size: usize) -> Option<()> {
        match self.sram_offset(address, size) {
            Some(at) => self.write_sram(at, value, size),
            None if !Self::dma_reaches(address) => return None,
            None if size == 4 => self.peripheral_write(address, value),
            None => self.peripheral_write_narrow(address, value, size),
        }
        Some(())
    }

    /// Cycles the DMA waits for the port of `address`, or for flash.
    fn dma_waits(&mut self, address: u32, write: bool) -> u64 {
        let now = self.now;
        match address >> 24 {
            0x10..=0x13 if !write => self.xip_access(DMA_MASTER, address, now).unwrap_or(0),
            0x40 => self.fabric.claim_for_dma(APB_PORT, now, write),
            0x50 => self.fabric.claim_for_dma(FAST_PORT, now, write),
            _ => match self.sram_offset(address, 1) {
                Some(at) => self.fabric.claim_for_dma(sram_port(at), now, write),
                None => 0,
            },
        }
    }
}
