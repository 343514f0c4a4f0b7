//! The 32-bit instructions: BL, MRS, MSR, DSB, DMB, ISB (ARMv6-M ARM, A5.3).

use super::{Bus, Cause, Cpu};

impl Cpu {
    /// Executes the 32-bit instruction whose first half is `first`.
    #[inline(always)]
    pub(super) fn wide(&mut self, bus: &mut Bus, first: u16) {
        let second = self.fetch(bus, self.regs.pc());
        if bus.attention {
            return;
        }
        self.regs.set_pc(self.at.wrapping_add(4));
        self.time += 2;
        if second & 0xd000 == 0xd000 {
            self.branch_and_link(first, second);
        } else {
            self.special(bus, first, second);
        }
    }

    /// `S:I1:I2:imm10:imm11:0` with I1 = not(J1 xor S), I2 = not(J2 xor S).
    #[inline(always)]
    fn branch_and_link(&mut self, first: u16, second: u16) {
        let (first, second) = (u32::from(first), u32::from(second));
        let s = first >> 10 & 1;
        let i1 = 1 ^ (second >> 13 & 1) ^ s;
        let i2 = 1 ^ (second >> 11 & 1) ^ s;
        let offset = s << 24 | i1 << 23 | i2 << 22 | (first & 0x3ff) << 12 | (second & 0x7ff) << 1;
        let offset = (offset << 7) as i32 >> 7;
        self.regs.r[14] = self.at.wrapping_add(4) | 1;
        self.branch(self.at.wrapping_add(4).wrapping_add_signed(offset));
    }

    #[inline(never)]
    fn special(&mut self, bus: &mut Bus, first: u16, second: u16) {
        match (first, second) {
            (0xf380..=0xf38f, _) if second & 0xff00 == 0x8800 => {
                let value = self.regs.r[usize::from(first & 0xf)];
                self.write_special(bus, second as u8, value);
            }
            (0xf3ef, _) if second & 0xf000 == 0x8000 => {
                let d = usize::from(second >> 8 & 0xf);
                self.regs.r[d] = self.read_special(second as u8);
            }
            // DSB, DMB, ISB: accesses complete in order here.
            (0xf3bf, _) if matches!(second & 0xfff0, 0x8f40 | 0x8f50 | 0x8f60) => {}
            _ => self.refuse(bus, Cause::Undefined { half: first }),
        }
    }

    /// SYSm as in B5.2.2; what is not there reads as zero.
    fn read_special(&self, register: u8) -> u32 {
        let regs = &self.regs;
        match register {
            0 => regs.apsr(),
            1 | 3 => regs.apsr() | regs.ipsr,
            2 => regs.apsr(),
            // IPSR; EPSR's Thumb bit reads as zero.
            5 | 7 => regs.ipsr,
            8 if !regs.on_psp() => regs.r[13],
            8 => regs.msp,
            9 if regs.on_psp() => regs.r[13],
            9 => regs.psp,
            16 => regs.primask,
            20 => regs.control,
            _ => 0,
        }
    }

    fn write_special(&mut self, bus: &mut Bus, register: u8, value: u32) {
        let regs = &mut self.regs;
        match register {
            0..=3 => regs.set_apsr(value),
            8 | 9 => {
                let psp = register == 9;
                if psp == regs.on_psp() {
                    regs.r[13] = value & !3;
                    self.stack.restart(value & !3);
                }
                if psp {
                    regs.psp = value & !3;
                } else {
                    regs.msp = value & !3;
                }
            }
            16 => {
                regs.primask = value & 1;
                bus.attention = true;
            }
            // SPSEL changes in Thread mode alone. Code is always privileged here; an image that gives that up is refused.
            20 if regs.ipsr == 0 => {
                if value & 1 != 0 {
                    self.refuse(bus, Cause::Unprivileged);
                    return;
                }
                regs.bank_sp();
                regs.control = value & 2;
                regs.unbank_sp();
            }
            _ => {}
        }
    }
}
