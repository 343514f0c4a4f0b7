//! One decoded instruction (ARMv6-M ARM, A6.7), with its cycles (TRM table 3.1).
//!
//! | cycles | instructions |
//! |---|---|
//! | 1 | arithmetic, moves, CPS, NOP, SEV, a branch not taken, accesses of SIO |
//! | 2 | loads and stores, B, BX, BLX, a write to PC, WFE, WFI |
//! | 3 | BL, MRS, MSR, barriers |
//! | 1 + N | LDM, STM, PUSH, POP of N |
//! | 3 + N | POP of N with PC |

use super::opcode::{Kind, Op};
use super::{Bus, Cause, Cpu, Sleep};

impl Cpu {
    /// A low register.
    #[inline(always)]
    fn low(&self, n: u8) -> u32 {
        self.regs.r[usize::from(n & 7)]
    }

    #[inline(always)]
    fn set_low(&mut self, n: u8, value: u32) {
        self.regs.r[usize::from(n & 7)] = value;
    }

    /// Any register; PC reads as the instruction's address + 4.
    #[inline(always)]
    fn any(&self, n: u8) -> u32 {
        if n == 15 {
            self.at.wrapping_add(4)
        } else {
            self.regs.r[usize::from(n & 15)]
        }
    }

    /// Writes any register: SP loses bits 1:0, PC branches.
    #[inline(always)]
    fn set_any(&mut self, n: u8, value: u32) {
        match n {
            15 => {
                self.time += 1;
                self.branch(value);
            }
            13 => self.regs.r[13] = value & !3,
            _ => self.regs.r[usize::from(n & 15)] = value,
        }
    }

    #[inline(always)]
    fn branch_if(&mut self, condition: bool, op: Op) {
        if condition {
            self.time += 1;
            let offset = (op.c as i8 as i32) << 1;
            self.branch(self.at.wrapping_add(4).wrapping_add_signed(offset));
        }
    }

    /// The stack pointer goes down to `sp`.
    #[inline(always)]
    fn lower_sp(&mut self, bus: &mut Bus, sp: u32) {
        self.regs.r[13] = sp;
        if self.stack.lower(sp) {
            self.refuse(bus, Cause::StackLimit { sp });
        }
    }

    /// Executes `op`, the decoded form of `half`.
    #[inline(always)]
    pub(super) fn execute<const WATCH: bool>(&mut self, bus: &mut Bus, op: Op, half: u16) {
        let Op { a, b, c, .. } = op;
        let imm = u32::from(c);
        self.time += 1;
        match op.kind {
            Kind::LslImm => {
                let value = self.regs.lsl(self.low(b), imm);
                self.set_low(a, value);
            }
            Kind::LsrImm => {
                let value = self.regs.lsr(self.low(b), imm);
                self.set_low(a, value);
            }
            Kind::AsrImm => {
                let value = self.regs.asr(self.low(b), imm);
                self.set_low(a, value);
            }
            Kind::AddReg => {
                let value = self.regs.add(self.low(b), self.low(c), false);
                self.set_low(a, value);
            }
            Kind::SubReg => {
                let value = self.regs.subtract(self.low(b), self.low(c));
                self.set_low(a, value);
            }
            Kind::AddImm => {
                let value = self.regs.add(self.low(b), imm, false);
                self.set_low(a, value);
            }
            Kind::SubImm => {
                let value = self.regs.subtract(self.low(b), imm);
                self.set_low(a, value);
            }
            Kind::MovImm => {
                let value = self.regs.result(imm);
                self.set_low(a, value);
            }
            Kind::CmpImm => {
                self.regs.subtract(self.low(a), imm);
            }
            Kind::And => {
                let value = self.regs.result(self.low(a) & self.low(b));
                self.set_low(a, value);
            }
            Kind::Eor => {
                let value = self.regs.result(self.low(a) ^ self.low(b));
                self.set_low(a, value);
            }
            Kind::LslReg => {
                let value = self.regs.lsl(self.low(a), self.low(b) & 0xff);
                self.set_low(a, value);
            }
            Kind::LsrReg => {
                let value = self.regs.lsr(self.low(a), self.low(b) & 0xff);
                self.set_low(a, value);
            }
            Kind::AsrReg => {
                let value = self.regs.asr(self.low(a), self.low(b) & 0xff);
                self.set_low(a, value);
            }
            Kind::Adc => {
                let value = self.regs.add(self.low(a), self.low(b), self.regs.c);
                self.set_low(a, value);
            }
            Kind::Sbc => {
                let value = self.regs.add(self.low(a), !self.low(b), self.regs.c);
                self.set_low(a, value);
            }
            Kind::RorReg => {
                let value = self.regs.ror(self.low(a), self.low(b) & 0xff);
                self.set_low(a, value);
            }
            Kind::Tst => {
                self.regs.result(self.low(a) & self.low(b));
            }
            Kind::Rsb => {
                let value = self.regs.subtract(0, self.low(b));
                self.set_low(a, value);
            }
            Kind::CmpReg => {
                self.regs.subtract(self.low(a), self.low(b));
            }
            Kind::Cmn => {
                self.regs.add(self.low(a), self.low(b), false);
            }
            Kind::Orr => {
                let value = self.regs.result(self.low(a) | self.low(b));
                self.set_low(a, value);
            }
            Kind::Mul => {
                let value = self.regs.result(self.low(a).wrapping_mul(self.low(b)));
                self.set_low(a, value);
            }
            Kind::Bic => {
                let value = self.regs.result(self.low(a) & !self.low(b));
                self.set_low(a, value);
            }
            Kind::Mvn => {
                let value = self.regs.result(!self.low(b));
                self.set_low(a, value);
            }
            Kind::AddHigh => self.set_any(a, self.any(a).wrapping_add(self.any(b))),
            Kind::CmpHigh => {
                self.regs.subtract(self.any(a), self.any(b));
            }
            Kind::MovHigh => self.set_any(a, self.any(b)),
            Kind::Bx => {
                self.time += 1;
                self.interwork(bus, self.any(b));
            }
            Kind::Blx => {
                self.time += 1;
                let target = self.any(b);
                self.regs.r[14] = self.regs.pc() | 1;
                self.interwork(bus, target);
            }
            Kind::LdrLiteral => {
                let base = self.at.wrapping_add(4) & !3;
                let value = self.load::<4, WATCH>(bus, base + 4 * imm);
                self.set_low(a, value);
            }
            Kind::StrReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                self.store::<4, WATCH>(bus, address, self.low(a));
            }
            Kind::StrhReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                self.store::<2, WATCH>(bus, address, self.low(a));
            }
            Kind::StrbReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                self.store::<1, WATCH>(bus, address, self.low(a));
            }
            Kind::LdrReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                let value = self.load::<4, WATCH>(bus, address);
                self.set_low(a, value);
            }
            Kind::LdrhReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                let value = self.load::<2, WATCH>(bus, address);
                self.set_low(a, value);
            }
            Kind::LdrbReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                let value = self.load::<1, WATCH>(bus, address);
                self.set_low(a, value);
            }
            Kind::LdrshReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                let value = self.load::<2, WATCH>(bus, address);
                self.set_low(a, value as u16 as i16 as u32);
            }
            Kind::LdrsbReg => {
                let address = self.low(b).wrapping_add(self.low(c));
                let value = self.load::<1, WATCH>(bus, address);
                self.set_low(a, value as u8 as i8 as u32);
            }
            Kind::StrImm => self.store::<4, WATCH>(bus, self.low(b).wrapping_add(imm), self.low(a)),
            Kind::StrhImm => {
                self.store::<2, WATCH>(bus, self.low(b).wrapping_add(imm), self.low(a))
            }
            Kind::StrbImm => {
                self.store::<1, WATCH>(bus, self.low(b).wrapping_add(imm), self.low(a))
            }
            Kind::LdrImm => {
                let value = self.load::<4, WATCH>(bus, self.low(b).wrapping_add(imm));
                self.set_low(a, value);
            }
            Kind::LdrhImm => {
                let value = self.load::<2, WATCH>(bus, self.low(b).wrapping_add(imm));
                self.set_low(a, value);
            }
            Kind::LdrbImm => {
                let value = self.load::<1, WATCH>(bus, self.low(b).wrapping_add(imm));
                self.set_low(a, value);
            }
            Kind::StrSp => {
                let address = self.regs.r[13].wrapping_add(4 * imm);
                self.store::<4, WATCH>(bus, address, self.low(a));
            }
            Kind::LdrSp => {
                let address = self.regs.r[13].wrapping_add(4 * imm);
                let value = self.load::<4, WATCH>(bus, address);
                self.set_low(a, value);
            }
            Kind::Adr => self.set_low(a, (self.at.wrapping_add(4) & !3) + 4 * imm),
            Kind::AddSpTo => self.set_low(a, self.regs.r[13].wrapping_add(4 * imm)),
            Kind::AddSp => self.regs.r[13] = self.regs.r[13].wrapping_add(4 * imm),
            Kind::SubSp => self.lower_sp(bus, self.regs.r[13].wrapping_sub(4 * imm)),
            Kind::Sxth => self.set_low(a, self.low(b) as i16 as u32),
            Kind::Sxtb => self.set_low(a, self.low(b) as i8 as u32),
            Kind::Uxth => self.set_low(a, self.low(b) & 0xffff),
            Kind::Uxtb => self.set_low(a, self.low(b) & 0xff),
            Kind::Rev => self.set_low(a, self.low(b).swap_bytes()),
            Kind::Rev16 => self.set_low(a, self.low(b).swap_bytes().rotate_right(16)),
            Kind::Revsh => self.set_low(a, (self.low(b) as u16).swap_bytes() as i16 as u32),
            Kind::Push => self.push::<WATCH>(bus, c, a != 0),
            Kind::Pop => self.pop::<WATCH>(bus, c, a != 0),
            Kind::Stm => self.store_multiple::<WATCH>(bus, a, c),
            Kind::Ldm => self.load_multiple::<WATCH>(bus, a, c),
            Kind::Nop => {}
            Kind::Beq => self.branch_if(self.regs.z == 0, op),
            Kind::Bne => self.branch_if(self.regs.z != 0, op),
            Kind::Bcs => self.branch_if(self.regs.c, op),
            Kind::Bcc => self.branch_if(!self.regs.c, op),
            Kind::Bmi => self.branch_if(self.regs.n >> 31 != 0, op),
            Kind::Bpl => self.branch_if(self.regs.n >> 31 == 0, op),
            Kind::Bvs => self.branch_if(self.regs.v, op),
            Kind::Bvc => self.branch_if(!self.regs.v, op),
            Kind::Bhi => self.branch_if(self.regs.c && self.regs.z != 0, op),
            Kind::Bls => self.branch_if(!self.regs.c || self.regs.z == 0, op),
            Kind::Bge => self.branch_if((self.regs.n >> 31 != 0) == self.regs.v, op),
            Kind::Blt => self.branch_if((self.regs.n >> 31 != 0) != self.regs.v, op),
            Kind::Bgt => {
                let greater = (self.regs.n >> 31 != 0) == self.regs.v;
                self.branch_if(self.regs.z != 0 && greater, op);
            }
            Kind::Ble => {
                let less = (self.regs.n >> 31 != 0) != self.regs.v;
                self.branch_if(self.regs.z == 0 || less, op);
            }
            Kind::B => {
                self.time += 1;
                let offset = i32::from((half << 5) as i16) >> 4;
                self.branch(self.at.wrapping_add(4).wrapping_add_signed(offset));
            }
            Kind::Wide => self.wide(bus, half),
            Kind::Cps | Kind::Wfe | Kind::Wfi | Kind::Sev | Kind::Svc | Kind::Bkpt => {
                self.rare(bus, op);
            }
            Kind::Undefined => self.refuse(bus, Cause::Undefined { half }),
        }
    }

    /// BX, BLX, POP to PC: bit 0 must be set, or the value names an exception return.
    #[inline(always)]
    pub(super) fn interwork(&mut self, bus: &mut Bus, target: u32) {
        if target >= 0xf000_0000 && self.regs.ipsr != 0 {
            self.return_from_exception(bus, target);
        } else if target & 1 == 0 {
            self.refuse(bus, Cause::NotThumb { target });
        } else {
            self.branch(target);
        }
    }

    fn push<const WATCH: bool>(&mut self, bus: &mut Bus, list: u8, lr: bool) {
        let count = list.count_ones() + u32::from(lr);
        let mut address = self.regs.r[13].wrapping_sub(4 * count);
        self.lower_sp(bus, address);
        for n in Bits(list) {
            self.store::<4, WATCH>(bus, address, self.low(n));
            address = address.wrapping_add(4);
        }
        if lr {
            self.store::<4, WATCH>(bus, address, self.regs.r[14]);
        }
    }

    fn pop<const WATCH: bool>(&mut self, bus: &mut Bus, list: u8, pc: bool) {
        let mut address = self.regs.r[13];
        for n in Bits(list) {
            let value = self.load::<4, WATCH>(bus, address);
            self.set_low(n, value);
            address = address.wrapping_add(4);
        }
        if !pc {
            self.regs.r[13] = address;
            return;
        }
        let target = self.load::<4, WATCH>(bus, address);
        self.regs.r[13] = address.wrapping_add(4);
        self.time += 2;
        if self.fault.is_none() {
            self.interwork(bus, target);
        }
    }

    fn store_multiple<const WATCH: bool>(&mut self, bus: &mut Bus, base: u8, list: u8) {
        let mut address = self.low(base);
        for n in Bits(list) {
            self.store::<4, WATCH>(bus, address, self.low(n));
            address = address.wrapping_add(4);
        }
        self.set_low(base, address);
    }

    fn load_multiple<const WATCH: bool>(&mut self, bus: &mut Bus, base: u8, list: u8) {
        let mut address = self.low(base);
        for n in Bits(list) {
            let value = self.load::<4, WATCH>(bus, address);
            self.set_low(n, value);
            address = address.wrapping_add(4);
        }
        // A base in the list keeps what was loaded.
        if list >> base & 1 == 0 {
            self.set_low(base, address);
        }
    }

    /// What leaves the straight way.
    #[inline(never)]
    fn rare(&mut self, bus: &mut Bus, op: Op) {
        bus.attention = true;
        match op.kind {
            Kind::Cps => self.regs.primask = u32::from(op.a),
            Kind::Sev => {
                bus.core_time = self.time;
                bus.signal_event();
            }
            Kind::Wfi => {
                self.time += 1;
                self.sleep = Sleep::Interrupt;
            }
            Kind::Wfe => {
                self.time += 1;
                if !std::mem::take(&mut bus.event[self.id]) {
                    self.sleep = Sleep::Event;
                }
            }
            Kind::Svc => self.supervisor_call(bus),
            _ => self.refuse(bus, Cause::Breakpoint),
        }
    }
}

/// The registers of a list, from the lowest.
struct Bits(u8);

impl Iterator for Bits {
    type Item = u8;

    #[inline(always)]
    fn next(&mut self) -> Option<u8> {
        if self.0 == 0 {
            return None;
        }
        let n = self.0.trailing_zeros() as u8;
        self.0 &= self.0 - 1;
        Some(n)
    }
}
