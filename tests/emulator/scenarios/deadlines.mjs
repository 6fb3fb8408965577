// Deadlines: each number of axes at the highest tick rate that the board accepts, and six axes at the rate that is the goal.
//
// The board accepts or refuses a tick rate by a model of the cost of a tick (firmware/link/src/board/rp2040.rs). It must keep an
// accepted rate: no deadline may be missed, also with all index sensors at one crank angle and corrections in motion. A count
// above zero is not exact: after a missed deadline the machine is behind the index pulses that the host predicts.

import { MISSED_DEADLINES, TICK_HZ } from '../bench/goals.mjs';
import { predict, refusedBy, scene, settingsOf, withAxes } from '../bench/host.mjs';
import { run as play, summary } from '../bench/ticks.mjs';

const AXES = [2, 3, 4, 5, 6];
const MOST_AXES = 6;

/** The settings accept no higher rate. */
const MOST_HZ = 10_000;

export const title = 'Deadlines: the highest tick rates that the board accepts';

export function run(outcome) {
  for (const axes of AXES) {
    const { tickHz, missed, trouble } = atMost(outcome, 'everything', axes);
    outcome.check(missed === 0 && trouble === undefined, `${axes} axes at ${tickHz} ticks a second: the log reports no trouble: ${trouble}`);
  }
  for (const axes of AXES) {
    const { tickHz, missed } = atMost(outcome, 'alike', axes);
    outcome.figure(`highest tick rate that the board accepts, ${axes} axes, ticks/s`, tickHz, 'higher');
    outcome.goal(`deadlines missed at that rate, ${axes} axes, index sensors at one angle`, missed, MISSED_DEADLINES);
  }
  atGoal(outcome);
}

const atRate = (name, axes, tickHz) => scene(name, (toml) => {
  withAxes(axes)(toml);
  toml.control.tick_hz = tickHz;
});

/** Runs a scene at the highest tick rate that the board accepts. */
function atMost(outcome, name, axes) {
  const refused = refusedBy(atRate(name, axes, MOST_HZ));
  const most = refused?.match(/at most (\d+) Hz/)?.[1];
  if (refused !== undefined && most === undefined) throw new Error(`the board names no rate that it accepts: ${refused}`);
  return keep(outcome, atRate(name, axes, Number(most ?? MOST_HZ)));
}

/** Runs a scene. Gives { tickHz, missed: deadlines, trouble: the first line of the log that reports any }. */
function keep(outcome, played) {
  const { ticks, period, lines } = play(played, predict(played), settingsOf(played));
  const missed = Math.max(logged(lines), passed(ticks));
  const trouble = lines.find((line) => /fault:|missed|late|lost|rejected/i.test(line))?.trim();
  const { worst, mean, pulses } = summary(ticks);
  outcome.say(
    `${played.name}, ${played.axes} axes at ${played.tickHz} ticks a second: ${missed} deadlines missed; worst tick ${worst} ` +
      `(${pulses} index pulses confirmed), mean ${mean.toFixed(0)} of ${period} cycles${trouble ? `; the log: ${trouble}` : ''}`,
  );
  return { tickHz: played.tickHz, missed, trouble };
}

/** Deadlines missed, as the log counts them. */
function logged(lines) {
  const counts = lines.map((line) => line.match(/(\d+) deadlines missed in all/)).filter(Boolean);
  return counts.length === 0 ? 0 : Number(counts[counts.length - 1][1]);
}

/** Deadlines missed, as the bench detects them: those at which the loop did not run. */
function passed(ticks) {
  return ticks.slice(1).reduce((sum, { number }, i) => sum + Math.max(number - ticks[i].number - 1, 0), 0);
}

function atGoal(outcome) {
  const played = atRate('alike', MOST_AXES, TICK_HZ);
  const refused = refusedBy(played);
  if (refused !== undefined) {
    outcome.reach(false, `${MOST_AXES} axes at ${TICK_HZ} ticks a second: skipped, as the board refuses it: ${refused}`);
    return;
  }
  const { missed } = keep(outcome, played);
  outcome.goal(`deadlines missed at ${TICK_HZ} ticks a second, ${MOST_AXES} axes, index sensors at one angle`, missed, MISSED_DEADLINES);
}
