// Runs one of the peer images in the npm package rp2040js and prints what it does, for `image_peer.rs`.
//
//     node image_peer.mjs <image.bin> <folder with node_modules> < scenario
//
// A line of the scenario is `<cycles after the mark> pin <pin> <level>`, `<cycles> uart <byte>`, `usb <text in hex>`, `watch <mask>` or
// `most <cycles>`; the mark is the trace's record 0x57. Lines of the answer:
//
//     t <cycle> <tag> <value>    a record of the trace           u <byte>…     UART bytes, USB bytes and descriptors: no cycle
//     p <cycle> <levels>         the watched pins changed         end <how>     the image's own end mark
//     a <name> <count>           an amendment was at work
//
// The package is a good emulator with known simplifications, and its clock is the host's. This shim steps it: an instruction, then as
// many cycles as that takes, one by one: pins, PIO, clock (DMA and timer). Where it departs from the datasheet it is put right here, each time
// under a name from `image_accepted.txt`, and counted. Nothing else is changed: what an instruction, a register or a transfer does is
// the package's own.

import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [imagePath, folder] = process.argv.slice(2);
const entry = createRequire(pathToFileURL(`${folder}/`)).resolve('rp2040js');
const { RP2040, USBCDC, StateMachine } = (await import(pathToFileURL(entry).href)).default ??
  (await import(pathToFileURL(entry).href));

const FLASH_VECTORS = 0x10000100;
const TRACE = 0x20000;
const MARK = 0x57;
const NANOS_PER_CYCLE = 8;
const WATCHDOG_TICK = 0x4005802c;
const TIMER_ALARM0 = 0x40054010;
const INPUT_DELAY = 2;
const APB_READ_WAITS = 2;
const APB_WRITE_WAITS = 3;
const EXCEPTION_ENTRY = 15;
const EXCEPTION_RETURN = 10;

const lines = readFileSync(0, 'utf8').split('\n').filter((line) => line.length > 0);
const scenario = { events: [], usb: '', watch: 0, most: 2_000_000 };
for (const line of lines) {
  const words = line.split(' ');
  if (words[0] === 'usb') scenario.usb = Buffer.from(words[1], 'hex').toString('latin1');
  else if (words[0] === 'watch') scenario.watch = Number(words[1]);
  else if (words[0] === 'most') scenario.most = Number(words[1]);
  else scenario.events.push({ at: Number(words[0]), what: words[1], values: words.slice(2).map(Number) });
}

const out = [];
const amended = new Map();
const amend = (name, count = 1) => amended.set(name, (amended.get(name) ?? 0) + count);

const chip = new RP2040();
chip.logger = { debug() {}, info() {}, warn() {}, error: (n, m) => out.push(`error ${n} ${m}`) };
chip.flash.set(readFileSync(imagePath));
const core = chip.core;

// No ROM: the image starts where boot2 would jump to.
amend('no-rom');
core.VTOR = FLASH_VECTORS;
core.SP = chip.readUint32(FLASH_VECTORS);
core.PC = chip.readUint32(FLASH_VECTORS + 4) & ~1;

let now = 0;
let mark = -1;

// ---- exceptions ------------------------------------------------------------------------------------------------------------------

let entered = 0;
const exceptionEntry = core.exceptionEntry.bind(core);
core.exceptionEntry = (number) => {
  entered += 1;
  exceptionEntry(number);
};
let left = 0;
const exceptionReturn = core.exceptionReturn.bind(core);
core.exceptionReturn = (value) => {
  left += 1;
  exceptionReturn(value);
};

// ---- timer -------------------------------------------------------------------------------------------------------------------

const timer = chip.peripherals[0x40054];
const write32 = chip.writeUint32.bind(chip);
chip.writeUint32 = (address, value) => {
  if ((address >>> 0) === WATCHDOG_TICK) {
    // The package's timer counts from power-on.
    amend('timer-start');
    chip.clock.nanosCounter = 0;
  }
  write32(address, value);
  const alarm = ((address >>> 0) - TIMER_ALARM0) / 4;
  if (alarm >= 0 && alarm < 4) {
    // The package drops the fraction of the microsecond that has passed, and fires early by it.
    amend('alarm-fraction');
    const whole = Math.floor(chip.clock.nanos / 1000);
    const wait = ((value - whole) >>> 0) * 1000 - (chip.clock.nanos - whole * 1000);
    timer.alarms[alarm].clockAlarm.schedule(wait);
  }
};

// ---- PIO -----------------------------------------------------------------------------------------------------------------------

const checkWait = StateMachine.prototype.checkWait;
const machines = chip.pio.flatMap((block) => block.machines);
for (const block of chip.pio) {
  block.run = () => amend('pio-bursts');
}
for (const machine of machines) {
  // Only a tick looks at what a stalled machine waits for.
  machine.checkWait = function () {
    if (this.ticking) checkWait.call(this);
  };
  machine.wasEnabled = false;
}

function tickMachine(machine) {
  const before = machine.cycles;
  machine.ticking = true;
  let used = 1;
  if (machine.waiting) {
    machine.checkWait();
    used += machine.cycles - before;
  } else {
    machine.updatePC = true;
    machine.executeInstruction(machine.pio.instructions[machine.pc]);
    if (machine.updatePC) machine.nextPC();
    used = Math.max(1, machine.cycles - before);
    if (used > 1) amend('pio-delay');
  }
  machine.ticking = false;
  const divider = ((machine.clockDivInt || 65536) << 8) + machine.clockDivFrac;
  if (divider !== 256) amend('pio-divider');
  machine.phase += used * divider;
  machine.due = machine.start + (machine.phase >> 8);
}

function tickPio() {
  for (const machine of machines) {
    if (!machine.enabled) {
      machine.wasEnabled = false;
      continue;
    }
    if (!machine.wasEnabled) {
      machine.wasEnabled = true;
      machine.start = now;
      machine.phase = 0;
      machine.due = now;
    }
    if (now >= machine.due) tickMachine(machine);
  }
  for (const block of chip.pio) block.checkChangedPins();
}

// ---- what comes from outside -------------------------------------------------------------------------------------------------

const pending = [];

function arrive() {
  while (pending.length > 0 && pending[0].cycle <= now) {
    const { what, values } = pending.shift();
    if (what === 'pin') {
      chip.gpio[values[0]].setInputValue(values[1] !== 0);
    } else {
      chip.uart[0].feedByte(values[0]);
    }
  }
}

function started() {
  for (const { at, what, values } of scenario.events) {
    let cycle = mark + at;
    if (what === 'pin') {
      amend('input-synchroniser');
      cycle += INPUT_DELAY;
    } else {
      amend('uart-line');
      cycle += values[1];
    }
    pending.push({ cycle, what, values });
  }
  pending.sort((a, b) => a.cycle - b.cycle);
}

chip.uart[0].onByte = (byte) => {
  amend('uart-line');
  out.push(`u uart ${byte}`);
};

const host = new USBCDC(chip.usbCtrl);
host.onDeviceConnected = () => {
  amend('usb-host');
  for (const char of scenario.usb) host.sendSerialByte(char.charCodeAt(0));
  const size = armed.get(host.outEndpoint);
  if (size !== undefined) {
    // The package forgets a buffer that was ready before it had read the descriptors.
    amend('usb-read-early');
    chip.usbCtrl.onEndpointRead(host.outEndpoint, size);
  }
};
const armed = new Map();
const onEndpointRead = chip.usbCtrl.onEndpointRead;
chip.usbCtrl.onEndpointRead = (endpoint, size) => {
  if (endpoint !== 0 && host.outEndpoint < 0) armed.set(endpoint, size);
  else onEndpointRead(endpoint, size);
};
host.cdcSetControlLineState = () => {
  // The package asks the device, where PSTN 1.2 has the interface.
  amend('usb-line-state');
  chip.usbCtrl.sendSetupPacket(Uint8Array.of(0x21, 0x22, 3, 0, 0, 0, 0, 0));
  host.initialized = true;
};
const usbBytes = [];
host.onSerialData = (bytes) => usbBytes.push(...bytes);

// ---- steps -------------------------------------------------------------------------------------------------------------------

let levels = 0;

function watchPins() {
  let seen = 0;
  for (let pin = 0; pin < 30; pin++) {
    if (scenario.watch & (1 << pin) && chip.gpio[pin].value === 1) seen |= 1 << pin;
  }
  if (seen !== levels) {
    levels = seen;
    if (mark >= 0) out.push(`p ${now} ${levels}`);
  }
}

function passCycles(count) {
  for (let n = 0; n < count; n++) {
    now += 1;
    arrive();
    tickPio();
    chip.clock.tick(NANOS_PER_CYCLE);
    if (scenario.watch) watchPins();
  }
}

let records = 0;

function readTrace() {
  const count = chip.sramView.getUint32(TRACE, true);
  while (records < count) {
    const at = TRACE + 8 + 8 * records;
    const tag = chip.sramView.getUint32(at, true);
    out.push(`t ${now} ${tag} ${chip.sramView.getUint32(at + 4, true)}`);
    if (tag === MARK) {
      mark = now;
      started();
    }
    records += 1;
  }
}

while (now < scenario.most && chip.sramView.getUint32(TRACE + 4, true) === 0) {
  if (core.waiting) {
    passCycles(1);
  } else if (core.interruptsUpdated) {
    core.checkForInterrupts();
  }
  if (entered > 0) {
    entered -= 1;
    core.waiting = false;
    amend('exception-entry');
    passCycles(EXCEPTION_ENTRY);
  } else if (!core.waiting) {
    instruction();
  }
}

function instruction() {
  const opcode = chip.readUint16(core.PC & ~1);
  let before = 0;
  const waits = waitsOfSeveral(opcode);
  if (onThePeripheralBus(opcode)) {
    amend('data-phase');
    before = 1;
    passCycles(before);
  }
  // What came in that cycle is taken after the instruction.
  const updated = core.interruptsUpdated;
  core.interruptsUpdated = false;
  let cycles = corrected(opcode, core.executeInstruction()) + waits;
  core.interruptsUpdated ||= updated;
  if (left > 0) {
    left -= 1;
    amend('exception-return');
    cycles += EXCEPTION_RETURN;
  }
  readTrace();
  if (scenario.watch) watchPins();
  passCycles(cycles - before);
}

// The waits of the APB bridge that the package counts for single accesses, in LDM and STM.
function waitsOfSeveral(opcode) {
  if (opcode >> 12 !== 0xc || core.registers[(opcode >> 8) & 7] >>> 28 !== 4) return 0;
  amend('apb-waits');
  let registers = 0;
  for (let n = 0; n < 8; n++) registers += (opcode >> n) & 1;
  return registers * (opcode & 0x800 ? APB_READ_WAITS : APB_WRITE_WAITS);
}

// Whether the instruction loads or stores outside memory.
function onThePeripheralBus(opcode) {
  const r = core.registers;
  const base = r[(opcode >> 3) & 7];
  let address = 0;
  switch (opcode >> 12) {
    case 0x5:
      address = base + r[(opcode >> 6) & 7];
      break;
    case 0x6:
      address = base + 4 * ((opcode >> 6) & 31);
      break;
    case 0x7:
      address = base + ((opcode >> 6) & 31);
      break;
    case 0x8:
      address = base + 2 * ((opcode >> 6) & 31);
      break;
    case 0xc:
      address = r[(opcode >> 8) & 7];
      break;
  }
  return [0x4, 0x5, 0xd, 0xe].includes((address >>> 0) >>> 28);
}

function corrected(opcode, cycles) {
  if (opcode >> 8 === 0b10110101) {
    amend('push-lr');
    return cycles + 1;
  }
  if (opcode >> 8 === 0b10111101) {
    amend('pop-pc');
    return cycles + 1;
  }
  return cycles;
}

if (usbBytes.length > 0 || host.descriptors.length > 0) {
  out.push(`u usb ${usbBytes.join(' ')}`);
  out.push(`u configuration ${host.descriptors.join(' ')}`);
}
for (const [name, count] of amended) out.push(`a ${name} ${count}`);
out.push(`end ${chip.sramView.getUint32(TRACE + 4, true)} ${now}`);
console.log(out.join('\n'));
process.exit(0);
