//! What the mask ROM does when the cores start: boot2's check of core 0, the wait for a launch of core 1.
//!
//! Source: RP2040 datasheet 2.8.1.3.1 (boot2), 2.8.2 (launching core 1).

use super::Chip;

/// CRC-32 of boot2: polynomial 04C11DB7, initial ones, not reflected, no final inversion (datasheet 2.8.1.3.1).
pub(super) fn boot2_crc(bytes: &[u8]) -> u32 {
    bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 24, |crc, _| {
            if crc & 1 << 31 != 0 {
                crc << 1 ^ 0x04c1_1db7
            } else {
                crc << 1
            }
        })
    })
}

impl Chip {
    /// Core 1 in ROM answers each word of the launch sequence 0, 0, 1, VTOR, SP, PC with itself (datasheet 2.8.2).
    pub(super) fn listen_for_launch(&mut self) {
        const PREFIX: [u32; 3] = [0, 0, 1];
        while let Some(word) = self.bus.sio.fifo[1].pop_front() {
            self.bus.sio.fifo[0].push_back(word);
            let n = self.launch.len();
            if n < PREFIX.len() && PREFIX[n] != word {
                self.launch.clear();
                if word == 0 {
                    self.launch.push(0);
                }
                continue;
            }
            self.launch.push(word);
            if let [_, _, _, vtor, sp, pc] = self.launch[..] {
                self.launch.clear();
                let starts = self.bus.now.max(self.cores[0].cpu.time);
                let core = &mut self.cores[1];
                core.restart(1, starts);
                core.cpu.start(sp, pc);
                core.stopped = false;
                self.bus.ppb[1].vtor = vtor;
                self.bus.asleep[1] = false;
                self.bus.wfe[1] = false;
                self.bus.event[1] = true;
            }
        }
        self.bus.event[0] = true;
        self.bus.update_lines();
    }
}
