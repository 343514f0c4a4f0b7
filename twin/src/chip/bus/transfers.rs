//! DMA transfers: the bus makes them, since it owns the memories.

use super::fabric::{APB_PORT, FAST_PORT};
use super::xip::DMA_MASTER;
use super::{Bus, sram_port};

impl Bus {
    pub(super) fn dreq(&self, number: u32) -> bool {
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
            32 | 34 => self.i2c[(n - 32) / 2].tx_ready(),
            33 | 35 => self.i2c[(n - 32) / 2].rx_ready(),
            36 => self.adc.ready(),
            0x3f => true,
            _ => false,
        }
    }

    /// One transfer, and the cycle of the next.
    pub(super) fn move_data(&mut self) {
        let Some(n) = self.dma.pick(|d| self.dreq(d)) else {
            // Nothing is ready: the next transfer follows the next event that makes a DREQ.
            self.dma_at = u64::MAX;
            return;
        };
        let c = self.dma.channels[n];
        let wait = self
            .dma_waits(c.read_addr, false)
            .max(self.dma_waits(c.write_addr, true));
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
        self.dma_at = self.now + 1 + wait;
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

    /// A word as a bus master other than the cores reads it.
    pub(super) fn load(&mut self, address: u32) -> u32 {
        match self.memory(address, 4) {
            Some(bytes) => u32::from_le_bytes(bytes.try_into().expect("four bytes")),
            None => self.peripheral_read(address),
        }
    }

    pub(super) fn store(&mut self, address: u32, value: u32) {
        match self.sram_offset(address, 4) {
            Some(at) => self.write_sram(at, value, 4),
            None => self.peripheral_write(address, value),
        }
    }

    pub(super) fn store_narrow(&mut self, address: u32, value: u32, size: usize) {
        match self.sram_offset(address, size) {
            Some(at) => self.write_sram(at, value, size),
            None => self.peripheral_write_narrow(address, value, size),
        }
    }
}
