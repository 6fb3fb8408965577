// Settings in use: one flipped bit of a setting, while the machine runs, ends with the drives off.
//
// A machine of four axes turns at a constant speed. Then one bit of a setting changes in its controller in RAM. Each setting is found by
// its value, however the fields are arranged. State may have the same value, such as the speed up to which there is no band: it changes
// alike.

import { scene, settingsOf } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import { Snapshot } from '../board/snapshot.mjs';

export const title = 'Settings in use: a flipped bit, and the drives are off';

/** Ticks of a round of the check for a machine without bands and cam tables (docs/loop.md). A bit is found in the round after it at last. */
const roundOf = ({ axes, toml }) => 76 + 11 * axes + 4 * toml.program.length;

/** Time from the end of the drives to the first ticks after the restart. */
const RESTARTED_S = 0.2;

/** Lowest and highest bit that are flipped, of each word of a setting. */
const BITS = [0, 31];

const TURN = 2 ** 48;

/** Settings: name, and words that follow each other in RAM. */
const SETTINGS = [
  ['speed limit of the shaft', ({ toml, tickHz }) => words(Math.floor((toml.limits.speed_hz / tickHz) * TURN))],
  ['half-steps per turn of an axis', ({ toml }) => [2 * toml.axes.steps_per_turn]],
  ['cycles of a tick', ({ tickHz }) => [CYCLES_PER_S / tickHz]],
];

const words = (value) => [value % 2 ** 32, Math.floor(value / 2 ** 32)];

export function run(outcome) {
  const played = scene('hold');
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  machine.start();
  machine.run(0.25);
  const running = new Snapshot(machine);
  for (const [name, valueOf] of SETTINGS) {
    const value = valueOf(played);
    const found = addresses(machine.board, value);
    outcome.check(found.length > 0, `${name}: ${value} is in the controller`);
    if (found.length === 0) continue;
    const cases = value.flatMap((_, word) => BITS.map((bit) => [word, bit]));
    const times = cases.map(([word, bit]) => {
      running.restore();
      const flipped = found.map((address) => address + 4 * word);
      return flips(outcome, machine, `${name}, bit ${bit} of word ${word}`, flipped, bit, 2 * roundOf(played));
    });
    outcome.say(`${name.padEnd(34)} drives off after ${times.map((seconds) => (1e3 * seconds).toFixed(1)).join(', ')} ms`);
  }
  running.restore();
  machine.run((4 * roundOf(played)) / played.tickHz);
  outcome.check(machine.level('enable') === 1, 'without a flipped bit the drives stay on');
}

/** Addresses in the controller of words that follow each other. */
function addresses(board, value) {
  const [controller] = [...board.elf.symbols.values()].filter(({ name, size }) => size > 0 && /machine4make10CONTROLLER/.test(name));
  const found = [];
  for (let at = controller.address; at < controller.address + controller.size; at += 4) {
    if (value.every((word, i) => board.peek(at + 4 * i) === word)) found.push(at);
  }
  return found;
}

/** Flips a bit of words, and gives the time in seconds until the drives are off. */
function flips(outcome, machine, name, flipped, bit, maxTicks) {
  const { board } = machine;
  const happened = board.cycle;
  for (const address of flipped) board.poke(address, (board.peek(address) ^ (1 << bit)) >>> 0);
  const max = maxTicks * machine.tick;
  board.run({ cycles: max + RESTARTED_S * CYCLES_PER_S });
  const [fall = Infinity] = board.edges.to('enable', 0).filter((cycle) => cycle >= happened);
  outcome.check(fall - happened <= max, `${name}: the drives are off within ${maxTicks} ticks, not after ${(fall - happened) / machine.tick}`);
  outcome.check(machine.level('enable') === 0, `${name}: the drives stay off`);
  const reset = board.events.some(({ kind, text, cycle }) => kind === 'reset' && text === 'watchdog' && cycle > happened);
  outcome.check(reset, `${name}: the watchdog resets the controller`);
  outcome.check(log(board).some((line) => /fault: watchdog-reset/.test(line)), `${name}: the log says watchdog-reset`);
  return (fall - happened) / CYCLES_PER_S;
}
