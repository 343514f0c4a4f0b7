//! Exceptions in the twin and in QEMU: random orders of SVC, PendSV, interrupts and HardFaults, nested by priority.
//!
//! ```text
//!   2000_0000  branch to the code at 0200; variables at 0100 (shared with `image`), 0140: log, actions, scratch
//!   2000_0200  interpreter of steps, one handler for all exceptions
//!   2000_0600  steps (kind, address, value), actions (address, value)
//!   2000_1400  log; stacks below 1400 (process) and 3f00 (main); 2000_3f00 the twin's vectors (QEMU's are in its flash)
//! ```
//! The thread executes steps: pends, changes priorities, masks, switches stacks, misaligns them, faults. Each handler logs IPSR,
//! EXC_RETURN, SP, PSP, PRIMASK, the stacked r0 and xPSR (and, in HardFault, the stacked PC, which it then moves past the instruction),
//! and carries out one action, which may pend something that preempts it or waits. Logs must be the same word for word. A store that
//! pends is followed by DSB and ISB, since QEMU takes exceptions between blocks of instructions.

use super::assembly::Assembly;
use super::class::Class;
use super::dice::Dice;
use super::image::{self, RAM, RAM_BYTES};
use super::sides;

const LOG_POINTER: u32 = RAM + 0x140;
const ACTION_POINTER: u32 = RAM + 0x144;
const SCRATCH: u32 = RAM + 0x148;
const CODE: u32 = RAM + 0x200;
const STEPS: u32 = RAM + 0x600;
const ACTIONS: u32 = RAM + 0xb00;
const PROCESS_STACK: u32 = RAM + 0x1400;
const LOG: u32 = RAM + 0x1400;
const LOG_END: u32 = RAM + 0x3c00;
const MAIN_STACK: u32 = RAM + 0x3f00;
const VECTORS: u32 = RAM + 0x3f00;

const STEPS_IN_ALL: usize = 50;
/// Pairs; each exception uses one up.
const ACTIONS_IN_ALL: usize = 150;
/// Vectors up to the last interrupt used.
const VECTOR_COUNT: usize = 16 + 24;
/// Interrupts that no peripheral of either chip raises here.
const FIRST_IRQ: u32 = 20;

const ICSR: u32 = 0xe000_ed04;
const SHPR2: u32 = 0xe000_ed1c;
const SHPR3: u32 = 0xe000_ed20;
const ISER: u32 = 0xe000_e100;
const ISPR: u32 = 0xe000_e200;
const IPR5: u32 = 0xe000_e414;

/// What the thread does.
#[derive(Clone, Copy)]
enum Step {
    Store = 1,
    Svc = 2,
    Primask = 3,
    Stack = 4,
    Lower = 5,
    Unaligned = 6,
    Undefined = 7,
}

/// A program: the RAM, and QEMU's vectors.
struct Program {
    ram: Vec<u8>,
    vectors: Vec<u8>,
}

/// Compares one program; the exceptions both sides took, or how they differ.
pub fn compare(seed: u64) -> Result<Result<u64, String>, String> {
    let program = program(seed);
    let twin = sides::in_twin_with(&program.ram, VECTORS);
    let qemu = sides::in_qemu_with(&program.ram, &program.vectors)?;
    let fault = |end: &sides::End| end.fault.clone().unwrap_or("none".into());
    if twin.fault.is_some() || qemu.fault.is_some() {
        let (t, q) = (fault(&twin), fault(&qemu));
        return Ok(Err(format!(
            "exceptions, seed {seed:#x}: twin {t}, QEMU {q}"
        )));
    }
    for at in (LOG..LOG_END)
        .step_by(4)
        .chain([LOG_POINTER, ACTION_POINTER])
    {
        let (t, q) = (image::word(&twin.ram, at), image::word(&qemu.ram, at));
        if t != q {
            return Ok(Err(format!(
                "exceptions, seed {seed:#x}: at {at:#x} twin {t:#x}, QEMU {q:#x}"
            )));
        }
    }
    let actions = image::word(&twin.ram, ACTION_POINTER) - ACTIONS;
    Ok(Ok(u64::from(actions / 8)))
}

fn program(seed: u64) -> Program {
    let mut dice = Dice::new(seed);
    let mut ram = vec![0; RAM_BYTES];
    let (code, handler) = code();
    let mut put = |at: u32, words: &[u32]| {
        for (n, word) in words.iter().enumerate() {
            let at = (at - RAM) as usize + 4 * n;
            ram[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
    };
    // `b CODE`.
    put(RAM, &[0xe000 | (CODE - RAM - 4) >> 1]);
    image::put_semihosting(&mut put);
    put(LOG_POINTER, &[LOG, ACTIONS]);
    let steps: Vec<u32> = steps(&mut dice);
    assert!(STEPS + 4 * steps.len() as u32 <= ACTIONS);
    put(STEPS, &steps);
    let actions: Vec<u32> = (0..ACTIONS_IN_ALL)
        .flat_map(|_| action(&mut dice))
        .collect();
    put(ACTIONS, &actions);
    let mut vectors = vec![handler | 1; VECTOR_COUNT];
    (vectors[0], vectors[1]) = (MAIN_STACK, RAM | 1);
    put(VECTORS, &vectors);
    let at = (CODE - RAM) as usize;
    ram[at..at + code.len()].copy_from_slice(&code);
    Program {
        ram,
        vectors: vectors.iter().flat_map(|word| word.to_le_bytes()).collect(),
    }
}

fn priorities(dice: &mut Dice) -> u32 {
    dice.bits() as u32 & 0xc0c0_c0c0
}

/// A pending exception: PendSV or one of four interrupts, or several of those.
fn pend(dice: &mut Dice) -> [u32; 2] {
    match dice.below(3) {
        0 => [ICSR, 1 << 28],
        1 => [ISPR, 1 << (FIRST_IRQ + dice.below(4))],
        _ => [ISPR, (1 + dice.below(15)) << FIRST_IRQ],
    }
}

fn action(dice: &mut Dice) -> [u32; 2] {
    match dice.below(5) {
        0 | 1 => pend(dice),
        _ => [SCRATCH, 0],
    }
}

fn steps(dice: &mut Dice) -> Vec<u32> {
    let mut steps = vec![Step::Store as u32, ISER, 0xf << FIRST_IRQ];
    for _ in 0..STEPS_IN_ALL {
        let step = match dice.below(12) {
            0 => [Step::Store as u32, IPR5, priorities(dice)],
            1 => [Step::Store as u32, SHPR2, priorities(dice) & 0xff00_0000],
            2 => [Step::Store as u32, SHPR3, priorities(dice) & 0x00ff_0000],
            3..=6 => {
                let [address, value] = pend(dice);
                [Step::Store as u32, address, value]
            }
            7 => [Step::Primask as u32, 0, dice.below(2)],
            8 => [Step::Stack as u32, 0, 2 * dice.below(2)],
            9 => [Step::Lower as u32, 0, 0],
            10 => [Step::Unaligned as u32, SCRATCH + 1 + dice.below(3), 0],
            _ => [Step::Undefined as u32, 0, 0],
        };
        steps.extend(step);
        if dice.one_in(4) {
            // Where nothing masks it: an SVC that cannot be taken is a HardFault.
            steps.extend([Step::Primask as u32, 0, 0, Step::Svc as u32, 0, 0]);
        }
    }
    steps.extend([Step::Primask as u32, 0, 0, 0, 0, 0]);
    steps
}

/// The interpreter and the handler, and the handler's address.
fn code() -> (Vec<u8>, u32) {
    const SYNC: [u16; 4] = [0xf3bf, 0x8f4f, 0xf3bf, 0x8f6f]; // dsb; isb
    const NOT_EQUAL: u16 = 1;
    let mut a = Assembly::new(CODE);
    let emit = |a: &mut Assembly, halfwords: &[u16]| {
        for halfword in halfwords {
            a.put(Class::Exception, *halfword);
        }
    };
    emit(&mut a, &[0xb672]); // cpsid i
    a.literal(0, PROCESS_STACK);
    emit(&mut a, &[0xf380, 0x8809]); // msr psp, r0
    a.literal(0, MAIN_STACK);
    emit(&mut a, &[0x4685]); // mov sp, r0
    a.literal(7, STEPS);
    let next = a.here();
    emit(&mut a, &[0xcf07, 0x2800]); // ldm r7!, {r0-r2}; cmp r0, #0
    let to_finish = a.here();
    emit(&mut a, &[0xd000]);
    let bodies: [(Step, &[u16]); 7] = [
        (Step::Store, &[0x600a]),           // str r2, [r1]
        (Step::Svc, &[0xdf07]),             // svc #7
        (Step::Primask, &[0xf382, 0x8810]), // msr primask, r2
        (Step::Stack, &[0xf382, 0x8814]),   // msr control, r2
        (Step::Lower, &[0xb081]),           // sub sp, #4
        (Step::Unaligned, &[0x680b]),       // ldr r3, [r1]
        (Step::Undefined, &[0xde00]),       // udf #0
    ];
    for (step, body) in bodies {
        emit(&mut a, &[0x2800 | step as u16]); // cmp r0, #step
        let over = a.here();
        emit(&mut a, &[0xd000]);
        emit(&mut a, body);
        emit(&mut a, &SYNC);
        a.branch(next);
        let here = a.here();
        a.patch(over, |a| a.branch_if(NOT_EQUAL, here));
    }
    let finish = a.here();
    a.patch(to_finish, |a| a.branch_if(0, finish));
    emit(&mut a, &[0x2000, 0xf380, 0x8814]); // movs r0, #0; msr control, r0
    image::tell(&mut a, image::DONE_WELL);

    let handler = a.here();
    emit(&mut a, &[0xb5f0]); // push {r4-r7, lr}
    emit(&mut a, &[0xf3ef, 0x8005]); // mrs r0, ipsr
    emit(&mut a, &[0x4671, 0x466a]); // mov r1, lr; mov r2, sp
    emit(&mut a, &[0xf3ef, 0x8309, 0xf3ef, 0x8410]); // mrs r3, psp; mrs r4, primask
    a.literal(5, LOG_POINTER);
    emit(&mut a, &[0x682e, 0xc61f]); // ldr r6, [r5]; stm r6!, {r0-r4}
    emit(&mut a, &[0x0749]); // lsls r1, r1, #29: bit 2 of EXC_RETURN
    emit(&mut a, &[0xd400, 0xab05]); // bmi .+4; add r3, sp, #20
    emit(&mut a, &[0x681a, 0x69dc, 0xc614]); // ldr r2, [r3]; ldr r4, [r3, #28]; stm r6!, {r2, r4}
    emit(&mut a, &[0x2803, 0xd103]); // cmp r0, #3; bne over
    emit(&mut a, &[0x699c, 0xc610, 0x3402, 0x619c]); // ldr r4, [r3, #24]; stm r6!, {r4}; adds r4, #2; str r4, [r3, #24]
    emit(&mut a, &[0x602e]); // over: str r6, [r5]
    a.literal(5, ACTION_POINTER);
    emit(&mut a, &[0x682e, 0xce18, 0x602e, 0x601c]); // ldr r6, [r5]; ldm r6!, {r3, r4}; str r6, [r5]; str r4, [r3]
    emit(&mut a, &SYNC);
    emit(&mut a, &[0xbdf0]); // pop {r4-r7, pc}
    let (code, _) = a.finish();
    assert!(
        CODE + code.len() as u32 <= STEPS,
        "the code outgrew its place"
    );
    (code, handler)
}
