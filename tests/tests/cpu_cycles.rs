//! What the twin charges for each kind of instruction against ARM's table (Cortex-M0+ TRM, DDI 0484C, table 3.1, zero wait states,
//! single-cycle multiplier, single-cycle I/O port) and against the bus of the RP2040 (datasheet 2.1.3). No peer checks cycles, so the
//! tables do.

use twin::chip::Chip;
use twin::chip::flash::Flash;

const CODE: u32 = 0x2000_0000;
const DATA: u32 = 0x2000_1000;

/// Name, instructions run before, the instruction, its cycles.
type Row = (&'static str, &'static [u16], &'static [u16], u64);

/// Before: r0 is [`DATA`], flags as at reset (all clear), SP set by `mov sp, r0` where needed.
const TABLE: &[Row] = &[
    ("movs rd, #imm", &[], &[0x2105], 1),
    ("adds rd, rn, rm", &[], &[0x1889], 1),
    ("lsls rd, rm, #5", &[], &[0x0149], 1),
    ("lsls rd, rm", &[], &[0x4091], 1),
    ("adcs", &[], &[0x4151], 1),
    ("muls", &[], &[0x4351], 1),
    ("cmp", &[], &[0x4291], 1),
    ("mov r8, r1", &[], &[0x4688], 1),
    ("adr", &[], &[0xa101], 1),
    ("sub sp, #8", &[], &[0xb082], 1),
    ("sxtb", &[], &[0xb251], 1),
    ("rev", &[], &[0xba11], 1),
    ("ldr rt, [rn, #imm]", &[], &[0x6801], 2),
    ("str rt, [rn, #imm]", &[], &[0x6001], 2),
    ("ldrb rt, [rn, rm]", &[], &[0x5c81], 2),
    ("ldr literal", &[], &[0x4900], 2),
    ("ldr rt, [sp]", &[0x4685], &[0x9900], 2),
    ("ldm of 3", &[], &[0xc80e], 4),
    ("stm of 3", &[], &[0xc00e], 4),
    ("push of 3", &[0x4685], &[0xb40e], 4),
    ("pop of 3", &[0x4685], &[0xbc0e], 4),
    // mov r1, pc; adds r1, #9; push {r1}; then pop {pc} of one.
    ("pop {pc}", &[0x4685, 0x4679, 0x3107, 0xb402], &[0xbd00], 4),
    ("beq not taken", &[], &[0xd000], 1),
    ("bne taken", &[], &[0xd1ff], 2),
    ("b", &[], &[0xe7ff], 2),
    ("bl", &[], &[0xf000, 0xf800], 3),
    // mov r1, pc; adds r1, #5.
    ("bx", &[0x4679, 0x3103], &[0x4708], 2),
    ("blx", &[0x4679, 0x3103], &[0x4788], 2),
    ("mov pc, rm", &[0x4679, 0x3102], &[0x468f], 2),
    ("add pc, rm", &[0x2100], &[0x448f], 2),
    ("cpsid i", &[], &[0xb672], 1),
    ("mrs", &[], &[0xf3ef, 0x8100], 3),
    ("msr", &[], &[0xf381, 0x8800], 3),
    ("dsb", &[], &[0xf3bf, 0x8f4f], 3),
    ("dmb", &[], &[0xf3bf, 0x8f5f], 3),
    ("isb", &[], &[0xf3bf, 0x8f6f], 3),
    ("nop", &[], &[0xbf00], 1),
    ("yield", &[], &[0xbf10], 1),
    ("sev", &[], &[0xbf40], 1),
    // movs r1, #0xd0; lsls r1, r1, #24.
    ("ldr from SIO", &[0x21d0, 0x0609], &[0x680a], 1),
    ("str to SIO", &[0x21d0, 0x0609], &[0x618a], 1),
    // movs r1, #0x40; lsls r1, r1, #24; movs r2, #0xc0; lsls r2, r2, #8; adds r1, r1, r2: RESETS.
    (
        "ldr from APB",
        &[0x2140, 0x0609, 0x22c0, 0x0212, 0x1889],
        &[0x680a],
        4,
    ),
    // The same; RESETS.WDSEL.
    (
        "str to APB",
        &[0x2140, 0x0609, 0x22c0, 0x0212, 0x1889, 0x2200],
        &[0x604a],
        5,
    ),
    ("ldr from ROM", &[0x2110], &[0x680a], 2),
];

/// Cycles the twin charges for the instruction.
fn charged(before: &[u16], instruction: &[u16]) -> u64 {
    let mut chip = Chip::new(Flash::new(1 << 20, [0; 8]));
    // The flash is empty on purpose: no program but the row's.
    chip.bus.fault = None;
    // nop; nop; b . behind it, wherever a branch lands.
    let code: Vec<u8> = [before, instruction, &[0xbf00, 0xbf00, 0xe7fe]]
        .concat()
        .iter()
        .flat_map(|halfword| halfword.to_le_bytes())
        .collect();
    chip.take_over(0, CODE, &code, DATA);
    chip.start_profile();
    let until = chip.now() + 200;
    chip.run_until(until).expect("the row runs");
    let at = CODE + 2 * before.len() as u32;
    let [core, _] = chip.profile().expect("it was started");
    core.addresses()
        .find(|(address, _)| *address == at)
        .expect("the instruction ran")
        .1
        .cycles
}

#[test]
fn each_kind_of_instruction_costs_what_the_table_says() {
    let mut wrong = Vec::new();
    for (name, before, instruction, cycles) in TABLE {
        let spent = charged(before, instruction);
        if spent != *cycles {
            wrong.push(format!("{name}: {spent} charged, the table has {cycles}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
