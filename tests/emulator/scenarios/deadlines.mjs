// Deadlines: no accepted settings can miss one, whatever coincides in a tick.
//
// The board accepts a tick rate by a bound on the longest tick (firmware/link/src/board/rp2040.rs). This search tries to exceed it. It
// draws scenes over all keys that cost time (search/draw.mjs), and changes those that came nearest to their bound. Each scene runs at the
// highest tick rate that the board accepts for it. The bench measures each tick by itself, from the deadline to the end of the loop's
// interrupt; the bound is what `cophase settings` states.

import { MISSED_DEADLINES } from '../bench/goals.mjs';
import { convert, scene } from '../bench/host.mjs';
import { stringify } from 'smol-toml';
import { accepted, atMost, countOr, SEED } from '../search/accepted.mjs';
import { draw, mutate, random } from '../search/draw.mjs';
import { NAMES } from '../search/parts.mjs';
import { play } from '../search/play.mjs';

/** Scenes that missed deadlines once, and the steps a second by which their cranks slip. */
const FIXED = ['longest-tick', 'missed-deadline'];
const SLIPS = [300, -200, 0, 150, 0, -90];

/** Scenes, the fixed ones included. */
const COUNT = countOr(8);

/** Share of the scenes that change one of the longest, once there are some; and how many of the longest are kept for that. */
const CLIMBING = 0.5;
const KEPT = 6;

/** Longest ticks that are printed. */
const SHOWN = 10;

export const title = 'Deadlines: a search for a tick longer than its bound';

export function run(outcome) {
  const next = random(SEED);
  const found = FIXED.map((name) => fixed(outcome, name));
  for (let number = found.length; number < COUNT; number += 1) {
    const best = found.filter(({ genome }) => genome).sort(byRatio).slice(0, KEPT);
    const climbs = best.length >= Math.min(KEPT, COUNT / 4) && next() < CLIMBING;
    const made = accepted(() => (climbs ? mutate(best[Math.floor(next() * best.length)].genome, next) : draw(next)));
    found.push(judge(outcome, `scene ${number}`, made, next));
  }
  report(outcome, found);
}

const byRatio = (one, other) => other.meter.worst.cycles / other.bound - one.meter.worst.cycles / one.bound;

/** A scene whose rate an earlier board accepted, and missed deadlines: refused, and played at the rate that the refusal names. */
function fixed(outcome, name) {
  const { toml } = scene(name);
  const first = convert({ text: stringify(toml) });
  outcome.check(first.maxHz !== undefined && !first.isWritten, `${name}: the rate is refused, and nothing is written, not: ${first.refused}`);
  return judge(outcome, name, { drawn: { toml, transport: 'usb', slips: SLIPS, override: null }, ...atMost(toml) }, random(SEED));
}

function judge(outcome, name, { genome, drawn, settings, bound }, next) {
  const { toml, transport } = drawn;
  const meter = play(drawn, settings, bound, next);
  const { worst, above, missed } = meter;
  const ratio = worst.cycles / bound;
  const what = `${name}, ${toml.axes.count} axes at ${toml.control.tick_hz} ticks a second, ${transport ?? 'no host'}`;
  outcome.say(`${what}: longest tick ${worst.cycles} of ${bound} cycles (${ratio.toFixed(3)}), ${worst.what}; ${meter.branches} branches`);
  if (above.length > 0 || missed > 0) outcome.say(`the scene:\n${stringify(toml)}`);
  outcome.check(above.length === 0, `${what}: no tick is longer than its bound, not ${above.length}`);
  outcome.check(missed === 0, `${what}: no deadline is missed, not ${missed}`);
  return { name, genome, toml, transport, bound, meter };
}

function report(outcome, found) {
  const worst = found.toSorted(byRatio);
  outcome.say(`the longest ticks beside their bounds, of ${found.length} scenes:`);
  for (const { name, toml, transport, bound, meter } of worst.slice(0, SHOWN)) {
    const { cycles, number, what, plans } = meter.worst;
    outcome.say(`    ${cycles} of ${bound} (${(cycles / bound).toFixed(3)}): ${name}, ${toml.axes.count} axes, ${plans ?? '?'} plans, ${toml.control.tick_hz} Hz, ${transport ?? 'no host'}, tick ${number}, ${what}`);
  }
  const max = (of) => Math.max(...found.map(({ meter }) => of(meter)));
  outcome.say('each part at its longest, in any tick:');
  outcome.say(`    ${NAMES.map((name, part) => `${name} ${max(({ parts }) => parts[part])}`).join(', ')}`);
  outcome.say(`    latest beginning ${max(({ late }) => late)}, preempted for ${max(({ preempted }) => preempted)}, a plan ${Math.round(max(({ plan }) => plan))}`);
  outcome.figure('search: longest tick beside its bound, ratio', worst[0].meter.worst.cycles / worst[0].bound, 'neither');
  outcome.figure('search: longest tick, cycles', max(({ worst: { cycles } }) => cycles), 'neither');
  outcome.goal('search: deadlines missed', found.reduce((sum, { meter }) => sum + meter.missed, 0), MISSED_DEADLINES);
  for (const axes of [2, 3, 4, 5, 6]) {
    const { toml } = scene('alike');
    toml.axes.count = axes;
    toml.axis = toml.axis.filter(({ number }) => number < axes);
    toml.fault = [];
    atMost(toml);
    outcome.figure(`highest tick rate that the board accepts, ${axes} axes, ticks/s`, toml.control.tick_hz, 'higher');
  }
}
