// Cost: the processor time of a control tick.
//
// A tick is the time that the loop's interrupt takes from its deadline, which wakes it, until it sleeps again: reading,
// computing and handing over. The time of the timer's and the channels' interrupts is counted too, and reported
// separately. None of them waits for the flash: all of their code runs from RAM.
//
// Two scenes: `everything`, with index sensors at different crank angles, and `alike`, with all of them at one angle and
// corrections in motion. In the second all index pulses come in one tick. The axes take turns by the number of the tick, so the tick of the
// start decides which work coincides: with six axes it starts at each tick of a round. `--profile` shows the functions that cost.

import { MEAN_TICK_CYCLES, WORST_TICK_CYCLES } from '../bench/goals.mjs';
import { predict, scene, settingsOf, withAxes } from '../bench/host.mjs';
import { namesAt } from '../bench/profile.mjs';
import { run as play, summary } from '../bench/ticks.mjs';

const SPREAD_AXES = [2, 4, 6];
const ALIKE_AXES = [2, 3, 4, 5, 6];
const GOAL_AXES = 6;

export const title = 'Cost: a control tick with everything on';

export function run(outcome) {
  for (const axes of SPREAD_AXES) {
    const played = measure(outcome, 'everything', axes);
    outcome.figure(`tick of ${axes} axes, worst, cycles`, played.worst);
    outcome.figure(`tick of ${axes} axes, mean, cycles`, Math.round(played.mean));
  }
  for (const axes of ALIKE_AXES) {
    const name = `tick of ${axes} axes, index sensors at one angle`;
    const played = measure(outcome, 'alike', axes);
    if (axes === GOAL_AXES) {
      outcome.goal(`${name}, worst, cycles`, played.worst, WORST_TICK_CYCLES);
      outcome.goal(`${name}, mean, cycles`, Math.round(played.mean), MEAN_TICK_CYCLES);
    } else {
      outcome.figure(`${name}, worst, cycles`, played.worst);
      outcome.figure(`${name}, mean, cycles`, Math.round(played.mean));
    }
    outcome.figure(`${name}, index pulses confirmed in the worst`, played.pulses, 'neither');
    for (const { state, worst, mean, pulses } of played.states) {
      const only = { inDocs: false };
      outcome.figure(`${name}, ${state}, worst, cycles`, worst, 'lower', only);
      outcome.figure(`${name}, ${state}, mean, cycles`, Math.round(mean), 'lower', only);
      outcome.figure(`${name}, ${state}, index pulses confirmed in the worst`, pulses, 'neither', only);
    }
  }
}

/** The summary of a scene's ticks, with those of its states. */
function measure(outcome, name, axes) {
  const played = scene(name, withAxes(axes));
  const predicted = predict(played);
  const settings = settingsOf(played);
  const starts = name === 'alike' && axes === GOAL_AXES ? axes : 1;
  const runs = Array.from({ length: starts }, (_, after) => play(played, predicted, settings, { prepare: (machine) => machine.run(after / played.tickHz) }));
  const [ticks, reads] = [runs.flatMap((run) => run.ticks), runs.flatMap((run) => run.reads)];
  const awake = runs.reduce((sum, run) => sum + run.awake, 0);
  const [{ period }] = runs;
  const all = summary(ticks);
  const states = [...new Set(ticks.map(({ state }) => state))].map((state) => ({
    state,
    ...summary(ticks.filter((tick) => tick.state === state)),
  }));
  outcome.say(
    `${name}, ${axes} axes: worst ${all.worst} (${all.pulses} index pulses confirmed), mean ${all.mean.toFixed(0)} cycles a tick of ` +
      `${period}; with all interrupts ${(awake / ticks.length).toFixed(0)}`,
  );
  for (const { state, worst, mean, pulses } of states) {
    outcome.say(`    ${state.padEnd(6)} worst ${String(worst).padStart(6)} (${pulses} index pulses), mean ${mean.toFixed(0).padStart(6)}`);
  }
  const waits = reads.filter(({ cycles }) => cycles > 0);
  const waited = `${name}, ${axes} axes: no interrupt waits for the flash${listed(waits)}`;
  if (name === 'everything') outcome.check(waits.length === 0, waited);
  else outcome.reach(waits.length === 0, waited);
  // Data that was in the cache this time may be missing from it the next time.
  if (axes === GOAL_AXES) outcome.reach(reads.length === 0, `${name}, ${axes} axes: no interrupt reads the flash${listed(reads)}`);
  return { ...all, states };
}

/** Reads of the flash in words: the function, the address, and the number of reads. */
function listed(reads) {
  if (reads.length === 0) return '';
  const names = namesAt([...new Set(reads.map(({ pc }) => pc & ~1))]);
  const all = reads.map(({ pc, address, count, cycles }) => `${names.get(pc & ~1)[0]} reads 0x${address.toString(16)} ${count} times and waits ${cycles} cycles`);
  return `: ${all.join('; ')}`;
}
