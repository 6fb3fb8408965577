// Rate: the number of steps a second that the firmware sustains on six axes, and their cost for the processor.
//
// The first part checks the promised rate, 1 M steps/s on each axis for 100 ms. Then the rate rises, with pulses as
// narrow as each rate needs, up to the last rate at which every deadline is met. Steps are counted at the pins. The log
// reports underruns of a machine and missed deadlines.

import { predict, scene, settingsOf } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';

const SECONDS = 0.1;
const PROMISED = 1e6;
const MAX_BUSY = 0.5;
const RISE = 250e3;
/** The settings accept no more than 2.93 M steps/s, however narrow the pulse. */
const MAX = 2.9e6;

export const title = 'Rate: six axes at a million steps a second each, and more';

export function run(outcome) {
  const promised = sustain(PROMISED);
  say(outcome, promised);
  outcome.check(promised.slowest >= PROMISED * 0.9999, `every axis makes ${PROMISED} steps/s, not ${promised.slowest}`);
  outcome.check(promised.busy < MAX_BUSY, `the processor is less than half busy, not ${(promised.busy * 100).toFixed(1)} %`);
  outcome.check(promised.trouble === undefined, `the log reports no trouble: ${promised.trouble}`);
  outcome.figure('six axes at 1 M steps/s: processor busy, %', promised.busy * 100);
  outcome.figure('six axes at 1 M steps/s: processor cycles a step', promised.cyclesPerStep);
  outcome.figure('six axes at 1 M steps/s: worst tick, cycles', promised.worst);

  let highest = promised;
  for (let rate = PROMISED + RISE; rate <= MAX; rate += RISE) {
    const tried = sustain(rate);
    if (tried.trouble !== undefined) {
      outcome.say(`${(rate / 1e6).toFixed(2)} M steps/s do not hold: ${tried.trouble}`);
      break;
    }
    highest = tried;
  }
  say(outcome, highest);
  outcome.figure('six axes, highest rate that holds, steps/s each', Math.round(highest.rate), 'higher');
}

function say(outcome, { rate, axes, busy, worst, cyclesPerStep }) {
  outcome.say(
    `${axes} axes at ${(rate / 1e6).toFixed(2)} M steps/s each, ${((axes * rate) / 1e6).toFixed(1)} M in all, for ${SECONDS * 1e3} ms: ` +
      `processor ${(busy * 100).toFixed(1)} % busy, worst tick ${worst} cycles, ${cyclesPerStep.toFixed(2)} cycles a step`,
  );
}

/** Runs the scene `fast` at another rate. `trouble` is the first bad line of the log, if there is one. */
function sustain(rate) {
  const played = scene('fast', (toml) => {
    const hz = rate / toml.axes.steps_per_turn;
    const omega = 2 * Math.PI * hz;
    const { crank_radius_mm: radius, lambda } = toml.machine;
    toml.limits.speed_hz = hz * 1.0002;
    toml.limits.acceleration_hz_per_s *= rate / PROMISED;
    toml.limits.jerk_hz_per_s2 *= rate / PROMISED;
    toml.program[0].hold_s = 0.2;
    toml.program[0].amax_g = ((omega * omega * radius) / 1e3) * (1 + lambda) * (1.00001 / 9.80665);
    // The part of a tick that remains at a change of direction must hold the pulse and 80 ns of guard, both ways
    // (docs/loop.md). The width is two cycles less for the rate's own slack, and for rounding down.
    toml.pulse.width_ns = 8 * Math.floor((375e6 / rate - 80) / 8 - 2);
  });
  const { report } = predict(played);
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const began = machine.start();
  // The hold begins after the ramp and the time that the shaft's limits add to it.
  const { homing } = report.time_in_state_s;
  const from = began + Math.round((homing + 0.08) * CYCLES_PER_S);
  machine.board.run({ untilCycle: from });
  const before = machine.board.usage.sums();
  machine.board.run({ untilCycle: from + SECONDS * CYCLES_PER_S });
  const after = machine.board.usage.sums();

  const counts = Array.from(
    { length: played.axes },
    (_, axis) => machine.board.edges.to(`step_${axis}`, 1).filter((cycle) => cycle >= from).length,
  );
  const awake = after.awake - before.awake;
  return {
    rate,
    axes: played.axes,
    slowest: Math.min(...counts) / SECONDS,
    busy: awake / (after.cycles - before.cycles),
    worst: Math.max(...machine.ticks(from).map(({ own }) => own)),
    cyclesPerStep: awake / counts.reduce((sum, count) => sum + count, 0),
    trouble: log(machine.board).find((line) => /fault|missed|late|lost/.test(line))?.trim(),
  };
}
