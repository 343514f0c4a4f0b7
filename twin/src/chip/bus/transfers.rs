//! DMA transfers: the bus makes them, since it owns the memories.

use super::Bus;

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
    pub(super) fn load(&mut self, address: u32) -> u32 {
        match self.memory(address, 4) {
            Some(bytes) => u32::from_le_bytes(bytes.try_into().expect("four bytes")),
            None => self.peripheral_read(address),
        }
    }

    pub(super) fn store(&mut self, address: u32, value: u32) {
        match self.sram_offset(address, 4) {
            Some(at) => self.sram[at..at + 4].copy_from_slice(&value.to_le_bytes()),
            None => self.peripheral_write(address, value),
        }
    }

    pub(super) fn store_narrow(&mut self, address: u32, value: u32, size: usize) {
        match self.sram_offset(address, size) {
            Some(at) => self.sram[at..at + size].copy_from_slice(&value.to_le_bytes()[..size]),
            None => self.peripheral_write_narrow(address, value, size),
        }
    }
}
