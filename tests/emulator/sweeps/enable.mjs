// The enable input is lost for a while, at any moment of a tick. In every other case the processor is stopped meanwhile.
//
// A pulse no longer than IGNORED is noise, without effect. One that lasts for DETECTED or longer is a loss: the drives are
// off within CUT, stay off, and the log reports the loss. Between these lengths either may happen.

import { log } from '../bench/log.mjs';
import { CYCLES_PER_S } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { sweep, isSelected } from '../bench/sweep.mjs';

const PULSES = 42;

const us = (time) => Math.round(time * 1e-6 * CYCLES_PER_S);
const IGNORED = us(8);
const DETECTED = us(10);
const CUT = us(10);
const LENGTHS = [1, 2, 5, 8, 10, 20, 50].map(us);

/** The processor is stopped for this time before the loss of the input, and after it. */
const BEFORE = us(30);
const AFTER_S = 400e-6;
const LOGGED_S = 0.008;

export function enablePulses(outcome, running) {
  if (!isSelected('enable')) return;
  const { machine, snapshot, follow } = running;
  const { board } = machine;
  sweep(outcome, 'enable', PULSES, 'µs to drives off', (u, v, number) => {
    snapshot.restore();
    const length = LENGTHS[number % LENGTHS.length];
    const frozen = number % 2 === 1;
    const at = running.deadline + Math.round(u * machine.tick);
    board.stimulus.pulse(at, pins.ENABLE, length);
    board.run({ untilCycle: at - BEFORE });
    if (frozen) machine.freeze(AFTER_S);
    machine.run(LOGGED_S);
    const falls = board.edges.to('enable', 0).filter((cycle) => cycle >= at);
    const lines = log(board);
    const logged = lines.some((line) => /enable-loss/.test(line));
    const wrong = [];
    if (length >= DETECTED) {
      if (!(falls[0] - at <= CUT)) wrong.push(`the drives are off after ${(falls[0] - at) / 125} µs`);
      if (machine.level('enable') !== 0 || falls.length > 1) wrong.push('the drives do not stay off');
      if (!logged) wrong.push('the log reports no enable-loss');
    }
    if (length <= IGNORED) {
      if (falls.length > 0) wrong.push('the drives are off');
      if (logged) wrong.push('the log reports enable-loss');
      if (!frozen) wrong.push(...follow.compare().wrong);
    }
    return {
      name: `gone for ${length / 125} µs, ${u.toFixed(4)} ticks after a deadline${frozen ? ', the processor standing' : ''}`,
      wrong,
      worst: falls.length > 0 ? (falls[0] - at) / 125 : undefined,
      ended: falls.length > 0 ? 'cut' : 'ignored',
      log: () => lines,
    };
  });
}
