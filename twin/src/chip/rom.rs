//! The mask ROM: no image is needed or shipped. The table header that programs read lies in memory; a call into ROM is performed by
//! the host.
//!
//! Source: RP2040 datasheet 2.8.3 (bootrom contents), function codes as listed there.
//!
//! | address | content |
//! |---|---|
//! | 10-13 | magic `Mu`, 1, version 2 |
//! | 14 16 18 | pointers to function table, data table, lookup function |
//! | 100 | lookup function |
//! | 200+4n | function n of [`FUNCTIONS`] |

use super::Chip;
use super::bus::{Fault, ROM};
use super::flash::{ERASE_SECTOR_US, PAGE, PROGRAM_PAGE_US, SECTOR};

const LOOKUP: u32 = 0x100;
const FIRST: u32 = 0x200;
/// Two-letter codes in the order of their entry points.
const FUNCTIONS: [&[u8; 2]; 18] = [
    b"IF", b"EX", b"RE", b"RP", b"FC", b"CX", b"MS", b"S4", b"MC", b"C4", b"P3", b"R3", b"L3",
    b"T3", b"UB", b"WV", b"DT", b"DE",
];
/// Cycles charged for a call whose cost is not modelled.
const CALL_CYCLES: u64 = 20;
/// Cycles a byte of the memory functions takes (word loops of the ROM: about 5 cycles for 4 bytes, plus overhead).
const CYCLES_PER_WORD: u64 = 5;

/// Fills in the ROM.
pub fn write_header(rom: &mut [u8]) {
    rom[0x10..0x14].copy_from_slice(b"Mu\x01\x02");
    rom[0x14..0x16].copy_from_slice(&0x0080u16.to_le_bytes());
    rom[0x16..0x18].copy_from_slice(&0x00c0u16.to_le_bytes());
    rom[0x18..0x1a].copy_from_slice(&(LOOKUP as u16 | 1).to_le_bytes());
}

impl Chip {
    /// Performs the ROM function core `k` has just branched to and returns to its caller.
    #[cold]
    pub(super) fn call_rom(&mut self, k: usize) {
        let core = &self.cores[k];
        let address = core.cpu.regs.pc();
        let argument = [0, 1, 2, 3].map(|n| core.cpu.regs.r[n]);
        let mut cycles = CALL_CYCLES;
        let result = if address == LOOKUP {
            let code = (argument[1] as u16).to_le_bytes();
            Some(
                FUNCTIONS
                    .iter()
                    .position(|f| **f == code)
                    .map_or(0, |n| (FIRST + 4 * n as u32) | 1),
            )
        } else {
            let n = (address.wrapping_sub(FIRST) / 4) as usize;
            match FUNCTIONS.get(n) {
                Some(code) if address >= FIRST => match self.perform(k, code, argument) {
                    Ok((result, cost)) => {
                        cycles += cost;
                        result
                    }
                    Err(fault) => {
                        self.bus.fault.get_or_insert(fault);
                        None
                    }
                },
                _ => {
                    self.bus.fault.get_or_insert(Fault::Rom { address });
                    None
                }
            }
        };
        let core = &mut self.cores[k];
        if let Some(value) = result {
            core.cpu.regs.r[0] = value;
        }
        core.rom_until = Some(core.cpu.time + cycles);
    }

    /// A ROM function of core `k` still takes its time, at most until `end`, or has just returned. Interrupts are taken meanwhile, and
    /// their handlers run.
    #[inline]
    pub(super) fn waits_in_rom(&mut self, k: usize, end: u64) -> bool {
        let core = &mut self.cores[k];
        let Some(until) = core.rom_until else {
            return false;
        };
        if core.cpu.regs.pc() as usize >= ROM {
            return false;
        }
        core.cpu.time = core.cpu.time.max(until.min(end));
        if core.cpu.time >= until {
            core.rom_until = None;
            let back = core.cpu.regs.r[14];
            core.cpu.go(back);
        }
        true
    }

    fn perform(
        &mut self,
        k: usize,
        code: &[u8; 2],
        a: [u32; 4],
    ) -> Result<(Option<u32>, u64), Fault> {
        let us = self.bus.sys_hz() / 1_000_000;
        let words = |bytes: u32| u64::from(bytes.div_ceil(4)) * CYCLES_PER_WORD;
        let range = Fault::FlashRange {
            offset: a[0],
            len: a[1],
        };
        Ok(match code {
            b"RE" => {
                if !self.bus.flash.erase(a[0] as usize, a[1] as usize) {
                    return Err(range);
                }
                let sectors = u64::from(a[1]) / SECTOR as u64;
                (None, self.flash_works(k, sectors * ERASE_SECTOR_US * us))
            }
            b"RP" => {
                let data: Vec<u8> = (0..a[2]).map(|i| self.bus.read8(a[1] + i)).collect();
                if !self.bus.flash.program(a[0] as usize, &data) {
                    return Err(Fault::FlashRange {
                        offset: a[0],
                        len: a[2],
                    });
                }
                let pages = u64::from(a[2]) / PAGE as u64;
                (None, self.flash_works(k, pages * PROGRAM_PAGE_US * us))
            }
            b"IF" | b"EX" => {
                self.bus.xip.command_mode = true;
                self.bus.flash.leave_xip();
                (None, 0)
            }
            b"FC" => {
                let now = self.cores[k].cpu.time;
                self.bus.xip.flush(now);
                (None, 0)
            }
            b"CX" => {
                self.bus.xip.command_mode = false;
                self.bus.flash.enter_plain_reads();
                (None, 0)
            }
            b"MS" | b"S4" => {
                for i in 0..a[2] {
                    self.bus.write8(a[0].wrapping_add(i), a[1] as u8);
                }
                (None, words(a[2]))
            }
            b"MC" | b"C4" => {
                self.bus.core_time = self.cores[k].cpu.time;
                for i in 0..a[2] {
                    let byte = self.bus.read8(a[1].wrapping_add(i));
                    self.bus.write8(a[0].wrapping_add(i), byte);
                }
                (None, words(a[2]))
            }
            b"P3" => (Some(a[0].count_ones()), 0),
            b"R3" => (Some(a[0].reverse_bits()), 0),
            b"L3" => (Some(a[0].leading_zeros()), 0),
            b"T3" => (Some(a[0].trailing_zeros()), 0),
            b"UB" => {
                return Err(Fault::UsbDrive {
                    led_pins: a[0],
                    disabled: a[1],
                });
            }
            other => {
                return Err(Fault::RomFunction(
                    String::from_utf8_lossy(&other[..]).into_owned(),
                ));
            }
        })
    }

    /// The flash is busy for `cycles`, which is what the call takes.
    fn flash_works(&mut self, k: usize, cycles: u64) -> u64 {
        let start = self.cores[k].cpu.time;
        self.bus.xip.busy_until = start + cycles;
        self.bus.paused |= self.bus.flash.journal.takes(start, start + cycles);
        cycles
    }
}
