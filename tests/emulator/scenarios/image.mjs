// Image: what can be seen of it without running a machine: no panic in the tick path, nothing of it in the flash, its
// size, its stack.
//
// The tick path is what runs at each deadline: the board's reading, the controller's tick, the handing over, and the
// interrupt that feeds the step machines. The call graph is that of the linked code (image-inspect). The stack is the
// deepest that was seen: at the first start on an empty flash, which is when a blob is decoded and stored, and in a run
// of six axes.

import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { blobOf, scene } from '../bench/host.mjs';
import { flashWith, Machine } from '../bench/machine.mjs';
import { HERE, IMAGE, INSPECT } from '../bench/paths.mjs';

const ROOTS = ['cophase_core::controller::Controller<_>::tick', 'cophase_firmware::control::Board<_>', 'DMA_IRQ_1'];

/** What runs beside it in interrupts, through pointers that no call graph follows; what wakes the loop's task is seen in `cost`. */
const BESIDE = [
  'TIMER_IRQ_0',
  'SWI_IRQ_0',
  'HardFault',
  'embassy_executor::raw::Executor::poll',
];

/** The chip's RAM, and what is to be left of it: an interrupt or two on top of the deepest stack that was seen. */
const RAM_BYTES = 264 * 1024;
const LEAST_LEFT = 4096;

export const title = 'Image: panics, what runs from RAM, size, stack';

export function run(outcome, { write = false, compare = true } = {}) {
  const allowed = path.join(HERE, 'panics-allowed.toml');
  const from = (roots) => roots.flatMap((root) => ['--root', root]);
  const panics = inspect(['panics', IMAGE, ...from(ROOTS), '--allow', allowed]);
  outcome.check(panics.status === 0, `no panic is reachable from the tick path:\n${panics.stdout}${panics.stderr}`);
  const reached = [...panics.stdout.matchAll(/functions reached: (\d+)/g)].map(([, count]) => Number(count));
  outcome.say(`${reached.length} roots, up to ${Math.max(...reached)} functions from each: no panic`);

  const places = inspect(['places', IMAGE, ...from([...ROOTS, ...BESIDE])]);
  outcome.check(places.status === 0, `nothing of the tick path is in the flash:\n${places.stdout}${places.stderr}`);

  const stack = Math.max(deepest({ flash: flashWith() }), deepest({ blob: blobOf(scene('everything')) }));
  const golden = path.join(HERE, 'image-size.toml');
  const against = compare ? ['--golden', golden, '--stack-bytes', String(stack), ...(write ? ['--bless'] : [])] : [];
  const size = inspect(['size', IMAGE, ...against]);
  outcome.check(size.status === 0, `the image is about as large as it was:\n${size.stdout}${size.stderr}`);
  const [, ram] = size.stdout.match(/^RAM +(\d+) bytes/m) ?? [];
  const left = RAM_BYTES - Number(ram) - stack;
  outcome.check(left >= LEAST_LEFT, `code, data and the deepest stack leave ${LEAST_LEFT} bytes of the RAM, not ${left}`);
  for (const line of size.stdout.split('\n').filter((text) => /^(flash|RAM|stack)/.test(text))) outcome.say(line);
}

function inspect(args) {
  const done = spawnSync(INSPECT, args, { encoding: 'utf8' });
  if (done.error) throw done.error;
  return done;
}

/** Bytes of stack from power-up to half a second of running. */
function deepest(settings) {
  const machine = new Machine({ axes: 6, tickHz: 2000, ...settings, options: { flashTimes: { eraseSector: 2000, programPage: 500 } } });
  machine.boot();
  machine.start();
  machine.run(0.5);
  return machine.board.stackDepth;
}
