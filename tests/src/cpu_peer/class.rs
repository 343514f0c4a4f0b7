//! The classes in which instructions are counted.

macro_rules! classes {
    ($($name:ident = $text:literal),* $(,)?) => {
        /// A class of ARMv6-M instructions.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Class { $(#[doc = $text] $name),* }

        impl Class {
            /// All of them, in the order of the table.
            pub const ALL: &[Class] = &[$(Class::$name),*];

            /// Its name in the table.
            pub fn name(self) -> &'static str {
                match self { $(Class::$name => $text),* }
            }
        }
    };
}

classes! {
    ShiftImmediate = "lsls lsrs asrs by immediate",
    AddSub = "adds subs, 3 operands",
    Immediate = "movs cmp adds subs #imm8",
    Logic = "ands eors orrs bics mvns tst",
    ShiftRegister = "lsls lsrs asrs rors by register",
    Carry = "adcs sbcs",
    Compare = "cmp cmn rsbs",
    Multiply = "muls",
    High = "add mov cmp of high registers",
    Address = "adr, add rd sp",
    Stack = "add sub sp",
    Extend = "sxth sxtb uxth uxtb",
    Reverse = "rev rev16 revsh",
    Literal = "ldr literal",
    Load = "ldr ldrh ldrb, immediate",
    Store = "str strh strb, immediate",
    LoadRegister = "ldr* by register, signed too",
    StoreRegister = "str* by register",
    StackLoadStore = "ldr str, sp-relative",
    Ldm = "ldm",
    Stm = "stm",
    Push = "push",
    Pop = "pop",
    PopPc = "pop with pc",
    BranchIf = "b<cond>",
    Branch = "b",
    BranchLink = "bl",
    BranchRegister = "bx blx",
    WritePc = "mov pc, add pc",
    Cps = "cps",
    Mrs = "mrs",
    Msr = "msr",
    BarrierHint = "barriers, nop yield sev",
    Exception = "exceptions taken and left",
}
