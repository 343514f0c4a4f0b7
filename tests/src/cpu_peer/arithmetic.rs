//! Units that work on registers alone, and the system instructions.

use super::class::Class;
use super::generator::Generator;

impl Generator {
    /// Any instruction on low registers.
    pub(super) fn arithmetic(&mut self) {
        let (rd, rn, rm) = (self.low(), self.low(), self.low());
        let imm8 = self.dice.below(256) as u16;
        match self.dice.below(11) {
            0 => {
                let (op, imm5) = (self.dice.below(3) as u16, self.dice.below(32) as u16);
                self.write(
                    Class::ShiftImmediate,
                    op << 11 | imm5 << 6 | rn << 3 | rd,
                    rd,
                );
            }
            1 => {
                let op = self.dice.below(4) as u16;
                self.write(Class::AddSub, 0x1800 | op << 9 | rm << 6 | rn << 3 | rd, rd);
            }
            2 => {
                let op = self.dice.below(4) as u16;
                self.a
                    .put(Class::Immediate, 0x2000 | op << 11 | rd << 8 | imm8);
                match op {
                    0 => self.known[usize::from(rd)] = Some(u32::from(imm8)),
                    1 => {}
                    _ => self.forget(rd),
                }
            }
            3 => {
                // and, eor, tst, orr, bic, mvn.
                let op = [0u16, 1, 8, 12, 14, 15][self.dice.below(6) as usize];
                self.a.put(Class::Logic, 0x4000 | op << 6 | rm << 3 | rd);
                if op != 8 {
                    self.forget(rd);
                }
            }
            4 | 5 => {
                // lsl, lsr, asr, ror; mostly by an amount of 0..255, else by whatever the register holds.
                let op = [2u16, 3, 4, 7][self.dice.below(4) as usize];
                if !self.dice.one_in(4) {
                    let amount = match self.dice.below(3) {
                        0 => [0, 1, 31, 32, 33, 63, 64, 255][self.dice.below(8) as usize],
                        1 => self.dice.below(34) as u16,
                        _ => imm8,
                    };
                    self.write(Class::Immediate, 0x2000 | rm << 8 | amount, rm);
                }
                self.write(Class::ShiftRegister, 0x4000 | op << 6 | rm << 3 | rd, rd);
            }
            6 => {
                let op = [5u16, 6][self.dice.below(2) as usize];
                self.write(Class::Carry, 0x4000 | op << 6 | rm << 3 | rd, rd);
            }
            7 => {
                // rsb, cmp, cmn.
                let op = 9 + self.dice.below(3) as u16;
                self.a.put(Class::Compare, 0x4000 | op << 6 | rm << 3 | rd);
                if op == 9 {
                    self.forget(rd);
                }
            }
            8 => self.write(Class::Multiply, 0x4340 | rm << 3 | rd, rd),
            9 => {
                let op = self.dice.below(4) as u16;
                self.write(Class::Extend, 0xb200 | op << 6 | rm << 3 | rd, rd);
            }
            _ => {
                let op = [0u16, 1, 3][self.dice.below(3) as usize];
                self.write(Class::Reverse, 0xba00 | op << 6 | rm << 3 | rd, rd);
            }
        }
    }

    /// add, cmp and mov with high registers (never to SP or PC here), adr, add rd sp.
    pub(super) fn high(&mut self) {
        const TARGETS: [u16; 14] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14];
        let rd = TARGETS[self.dice.below(14) as usize];
        let rm = self.dice.below(16) as u16;
        let low = self.low();
        let imm8 = self.dice.below(256) as u16;
        let encode =
            |op: u16, rd: u16, rm: u16| 0x4400 | op << 8 | (rd & 8) << 4 | rm << 3 | rd & 7;
        match self.dice.below(5) {
            0 => self.write(Class::High, encode(0, rd, rm), rd),
            1 => {
                // Both low, or the PC, are UNPREDICTABLE.
                let rm = [8, 9, 10, 11, 12, 13, 14][self.dice.below(7) as usize];
                self.a.put(Class::High, encode(1, rd, rm));
            }
            2 => {
                self.a.put(Class::High, encode(2, rd, rm));
                let value = self.known.get(usize::from(rm)).copied().flatten();
                self.known[usize::from(rd)] = value;
            }
            3 => self.write(Class::Address, 0xa000 | low << 8 | imm8, low),
            _ => self.write(Class::Address, 0xa800 | low << 8 | imm8, low),
        }
    }

    /// cps, mrs, msr, barriers and hints.
    pub(super) fn system(&mut self) {
        let rd = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14][self.dice.below(14) as usize];
        match self.dice.below(6) {
            0 => {
                let mask = self.dice.below(2) as u16;
                self.a.put(Class::Cps, 0xb662 | mask << 4);
                self.mrs(rd, 16);
            }
            1 => {
                // APSR, XPSR, IPSR, MSP, PSP, PRIMASK, CONTROL.
                let register = [0, 3, 5, 8, 9, 16, 20][self.dice.below(7) as usize];
                self.mrs(rd, register);
            }
            2 => {
                // APSR, XPSR; their reserved bits written as zero, since QEMU keeps a Q flag that ARMv6-M does not have.
                let register = [0, 3][self.dice.below(2) as usize];
                let (low, value) = (self.low(), self.dice.word() & 0xf7ff_ffff);
                self.load(low, value);
                self.msr(register, low);
            }
            3 => {
                self.msr(16, rd);
                self.mrs(rd, 16);
            }
            4 => {
                // The process stack in place of the main one, and back.
                let (value, read) = (self.low(), self.low());
                self.a.put(Class::High, 0x4668 | value); // mov value, sp
                self.msr(9, value);
                self.write(Class::Immediate, 0x2002 | value << 8, value);
                self.msr(20, value);
                self.a.put_wide(Class::BarrierHint, [0xf3bf, 0x8f6f]);
                let register = [8, 9, 20][self.dice.below(3) as usize];
                self.mrs(read, register);
                self.write(Class::Immediate, 0x2000 | value << 8, value);
                self.msr(20, value);
                self.a.put_wide(Class::BarrierHint, [0xf3bf, 0x8f6f]);
            }
            _ => {
                if self.dice.one_in(2) {
                    // dsb, dmb, isb.
                    let op = 4 + self.dice.below(3) as u16;
                    self.a
                        .put_wide(Class::BarrierHint, [0xf3bf, 0x8f0f | op << 4]);
                } else {
                    // nop, yield, sev.
                    let op = [0u16, 1, 4][self.dice.below(3) as usize];
                    self.a.put(Class::BarrierHint, 0xbf00 | op << 4);
                }
            }
        }
    }

    /// An instruction that writes `rd` something unknown.
    fn write(&mut self, class: Class, halfword: u16, rd: u16) {
        self.a.put(class, halfword);
        self.forget(rd);
    }

    fn mrs(&mut self, rd: u16, register: u16) {
        self.a
            .put_wide(Class::Mrs, [0xf3ef, 0x8000 | rd << 8 | register]);
        self.forget(rd);
    }

    fn msr(&mut self, register: u16, rn: u16) {
        self.a
            .put_wide(Class::Msr, [0xf380 | rn, 0x8800 | register]);
    }
}
