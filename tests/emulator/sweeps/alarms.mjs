// An alarm of two cycles at any moment of a tick; in every other case while the loop reads its inputs. None is lost, and each stops the
// machine once.

import { log } from '../bench/log.mjs';
import * as pins from '../bench/pins.mjs';
import { sweep, isSelected } from '../bench/sweep.mjs';

const ALARMS = 64;

/** The shortest pulse that the chip's edge detection is certain to see, in cycles: longer than one. */
export const MIN_PULSE = 2;

/** Cycles from a deadline within which the loop has read its inputs. */
const READING = 400;

const LOGGED_S = 0.008;

export function alarms(outcome, running) {
  if (!isSelected('alarms')) return;
  const { machine, snapshot } = running;
  sweep(outcome, 'alarms', ALARMS, '', (u, v, number) => {
    snapshot.restore();
    const within = number % 2 === 1 ? READING : machine.tick;
    const after = Math.floor(u * within);
    machine.board.stimulus.pulse(running.deadline + after, pins.ALARM[1], MIN_PULSE);
    machine.run(LOGGED_S);
    const lines = log(machine.board);
    const faults = lines.filter((line) => /fault: drive-alarm on axis 1/.test(line));
    const wrong = [];
    if (faults.length !== 1) wrong.push(`the log reports ${faults.length} alarms`);
    if (!lines.some((line) => /: Stop/.test(line))) wrong.push('the machine does not stop');
    return { name: `${after} cycles after a deadline`, wrong, ended: faults.length > 0 ? 'stopped' : 'lost', log: () => lines };
  });
}
