// The stop input at any moment of a tick and of a turn: all axes come to rest at the parking phase, to the step.

import { log } from '../bench/log.mjs';
import * as pins from '../bench/pins.mjs';
import { sweep, isSelected } from '../bench/sweep.mjs';

const STOPS = 10;

/** A turn of the scene, and the time to stop and to log it. */
const TURN_S = 1 / 12;
const PARKED_S = 0.2;

export function stops(outcome, running) {
  if (!isSelected('stops')) return;
  const { machine, snapshot, perTurn, reversed, parkDeg } = running;
  sweep(outcome, 'stops', STOPS, 'steps off the parking phase', (u, v) => {
    snapshot.restore();
    const ticks = Math.floor((v * TURN_S * 125e6) / machine.tick);
    machine.set(pins.STOP, 1, running.deadline + Math.round((ticks + u) * machine.tick));
    machine.run(v * TURN_S + PARKED_S);
    const steps = machine.steps(reversed);
    machine.run(0.01);
    const lines = log(machine.board);
    const wrong = [];
    if (!lines.some((line) => /: Parked/.test(line))) wrong.push('the log does not say Parked');
    if (machine.level('enable') !== 1) wrong.push('the drives do not hold');
    if (machine.steps(reversed).join() !== steps.join()) wrong.push('something still moves');
    // Whole turns of the master, and the parking phase.
    const turns = Math.floor(steps[0] / perTurn[0]) + parkDeg / 360;
    const off = Math.max(...steps.map((count, axis) => Math.abs(count - turns * perTurn[axis])));
    if (off >= 1) wrong.push(`the axes stand at ${steps.join(', ')} steps, and not ${turns} turns on`);
    return { name: `stop ${ticks} ticks and ${u.toFixed(4)} on`, wrong, worst: off, ended: 'parked', log: () => lines };
  });
}
