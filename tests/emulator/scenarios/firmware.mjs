// Firmware: checks without running a machine: no panic in the tick path, no code of the tick path in the flash, its size, its stack.
//
// The tick path is the code that runs at each deadline: the board's reading, the controller's tick, the handing over, and the interrupt
// that feeds the step machines. The call graph is that of the linked code (firmware-inspect). The stack is the deepest measured one, for
// each number of axes: from power-up through a run to a fault; and at the first start on an empty flash, when settings are decoded and
// stored.

import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import * as goals from '../bench/goals.mjs';
import { scene, settingsOf, withAxes } from '../bench/host.mjs';
import { flashWith, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { FIRMWARE, FIRMWARE_V0_NAMES, HERE, INSPECT } from '../bench/paths.mjs';

const ROOTS = ['cophase_core::controller::Controller<_>::tick', 'cophase_firmware::control::Board<_>', 'DMA_IRQ_1'];

/** The parts of the check of the settings, which a tick calls from a table. */
const PARTS = 'cophase_core::controller::checksum';

/** Roots of the other interrupts, which no call graph follows. Those of timers and host link have a lower priority than the loop. */
const BESIDE = ['TIMER_IRQ_1', 'HardFault', 'SWI_IRQ_0'];

/** The chip's RAM, and the reserve in it: an interrupt or two on top of the deepest measured stack. */
const RAM_BYTES = 264 * 1024;
const MIN_LEFT = 4096;

const MIN_AXES = 2;
const MAX_AXES = 6;
/** Axes of the scene `default`, which is built in. */
const BUILT_IN_AXES = 4;

export const title = 'Firmware: panics, what runs from RAM, size, stack';

export function run(outcome, { write = false, compare = true } = {}) {
  const allowed = path.join(HERE, 'panics-allowed.toml');
  const from = (roots) => roots.flatMap((root) => ['--root', root]);
  const panics = inspect(['panics', FIRMWARE, ...from([...ROOTS, PARTS]), '--allow', allowed]);
  outcome.check(panics.status === 0, `no panic is reachable from the tick path:\n${panics.stdout}${panics.stderr}`);
  const reached = [...panics.stdout.matchAll(/functions reached: (\d+)/g)].map(([, count]) => Number(count));
  outcome.say(`${reached.length} roots, up to ${Math.max(...reached)} functions from each: no panic`);

  const places = inspect(['places', FIRMWARE, ...from([...ROOTS, PARTS, ...BESIDE])]);
  outcome.check(places.status === 0, `nothing of the tick path is in the flash:\n${places.stdout}${places.stderr}`);

  otherNames(outcome);

  const { stack, axes } = deepestStack(outcome);
  const golden = path.join(HERE, 'image-size.toml');
  const against = compare ? ['--golden', golden, '--stack-bytes', String(stack), '--stack-axes', String(axes), ...(write ? ['--bless'] : [])] : [];
  const size = inspect(['size', FIRMWARE, ...against]);
  outcome.check(size.status === 0, `the firmware is about as large as it was:\n${size.stdout}${size.stderr}`);
  const [, ram] = size.stdout.match(/^RAM +(\d+) bytes/m) ?? [];
  const left = RAM_BYTES - Number(ram) - stack;
  outcome.check(left >= MIN_LEFT, `code, data and the deepest stack leave ${MIN_LEFT} bytes of the RAM, not ${left}`);
  for (const line of size.stdout.split('\n').filter((text) => /^(flash|RAM|stack)/.test(text))) outcome.say(line);
  const [, flash] = size.stdout.match(/^flash +(\d+) bytes/m) ?? [];
  outcome.goal('static RAM and the deepest stack, bytes', Number(ram) + stack, goals.RAM_BYTES);
  outcome.goal('flash, bytes', Number(flash), goals.FLASH_BYTES);
}

/** A tick may take longer by this factor with other names, as the compiler places other functions in line. */
const MAX_LONGER = 1.05;

/** What runs from RAM is chosen by the names of functions. With the compiler's other form of names a tick takes as long. */
function otherNames(outcome) {
  if (!fs.existsSync(FIRMWARE_V0_NAMES)) {
    outcome.say('the firmware with the other form of names is not built; not compared');
    return;
  }
  const settings = settingsOf(scene('everything', withAxes(2)));
  const [worst, other] = [FIRMWARE, FIRMWARE_V0_NAMES].map((file) => {
    const machine = new Machine({ axes: 2, tickHz: 2000, settings, options: { elf: fs.readFileSync(file) } });
    machine.boot();
    const began = machine.start();
    machine.run(0.2);
    return Math.max(...machine.ticks(began).map(({ own }) => own));
  });
  outcome.say(`worst tick ${worst} cycles, and ${other} with the compiler's other form of names`);
  outcome.check(other <= MAX_LONGER * worst, `with v0 names the loop runs from RAM: the worst tick takes ${other} cycles, not ${worst}`);
}

/** The deepest stack of all numbers of axes, bytes, and the number of axes at which it occurs. */
function deepestStack(outcome) {
  const first = { stack: deepest({ axes: MAX_AXES, flash: flashWith() }), axes: 'the first start' };
  const all = [];
  for (let axes = MIN_AXES; axes <= MAX_AXES; axes += 1) {
    all.push({ axes, stack: deepest({ axes, settings: settingsOf(scene('everything', withAxes(axes))) }) });
  }
  const max = all.reduce((deeper, run) => (run.stack > deeper.stack ? run : deeper));
  outcome.say(`deepest stack: ${[...all, first].map(({ stack, axes }) => `${axes}${axes > 0 ? ' axes' : ''} ${stack}`).join(', ')} bytes`);
  for (const { axes, stack } of all) outcome.figure(`stack of ${axes} axes, deepest, bytes`, stack, 'lower', { inDocs: false });
  outcome.figure('stack, deepest, bytes', Math.max(max.stack, first.stack));
  return first.stack > max.stack ? { stack: first.stack, axes: BUILT_IN_AXES } : max;
}

function inspect(args) {
  const done = spawnSync(INSPECT, args, { encoding: 'utf8' });
  if (done.error) throw done.error;
  return done;
}

/** Bytes of stack from power-up through half a second of running, a fault and the stop that follows. */
function deepest({ axes, settings, flash }) {
  const machine = new Machine({ axes, tickHz: 2000, settings, flash, options: { flashTimes: { eraseSector: 2000, programPage: 500 } } });
  machine.boot();
  machine.start();
  machine.run(0.5);
  machine.set(pins.ALARM[1], 1);
  machine.run(0.3);
  return machine.board.stackDepth;
}
