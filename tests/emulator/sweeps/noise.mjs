// Glitches on the index lines close to the pulses' own edges.
//
// A glitch is a stretch shorter than `index.width_us`: high before a pulse, low within it, high after it. In each case the
// last two pulses of six lines before a stop are disturbed, each line in another place. The reported phase error may then
// be off by the error of the filter (firmware/core/src/monitor/filter/mod.rs): a glitch up to two widths before a
// pulse counts as bouncing of the pulse. No other glitch changes the phase error.

import { log } from '../bench/log.mjs';
import { CYCLES_PER_S } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { spread, sweep, isSelected } from '../bench/sweep.mjs';
import { MAX_DEG, standsFor, TURN_HZ } from '../scenarios/index.mjs';

const NOISES = 12;

const WIDTH = 250; // index.width_us, 2 µs
const BRIDGED = 2;
/** Resolution of a stretch: one sampling of the lines, and another after a change. */
const POLL = 21;

const DEG_PER_CYCLE = (360 * TURN_HZ) / CYCLES_PER_S;

/** `ready`: a machine shortly before its stop, from scenarios/sweeps.mjs. */
export function noise(outcome, ready) {
  if (!isSelected('noise')) return;
  const { machine, snapshot, pulses, stands } = ready;
  sweep(outcome, 'noise', NOISES, '° off the phase', (u, v, number) => {
    snapshot.restore();
    const places = pulses.map((own, axis) => own.map((pulse) => disturb(machine, axis, pulse, spread(6 * number + axis))));
    machine.board.run({ untilCycle: ready.end });
    const lines = log(machine.board);
    const line = lines.find((text) => /Stop, phase error/.test(text));
    const phaseError = line?.match(/phase error \[(.*)\]/)[1].split(',').map(Number);
    const wrong = phaseError ? [] : ['the log reports no stop'];
    const off = (phaseError ?? []).map((deg, axis) => deg - stands[axis]);
    off.forEach((deg, axis) => {
      const [{ text, early }] = places[axis].slice(-1);
      // An early pulse means that the crank is ahead.
      const max = MAX_DEG + early * DEG_PER_CYCLE;
      if (!(deg >= -MAX_DEG && deg <= max)) wrong.push(`axis ${axis}, ${text}: ${deg.toFixed(4)}° off, and not -${MAX_DEG} to ${max.toFixed(4)}`);
    });
    return {
      name: places.map((own, axis) => `axis ${axis}: ${own[own.length - 1].text}`).join('; '),
      wrong,
      worst: Math.max(...off.map(Math.abs)),
      ended: 'in bounds',
      log: () => [line, stands.join(', ')],
    };
  });
}

/** True if a glitch may count as bouncing of the pulse: close to it, with no valid stretch in between. */
const isBridged = (length, apart) => apart < WIDTH + POLL && apart + length <= BRIDGED * WIDTH + POLL;

/**
 * Makes one glitch of up to a width. Gives its description, and the number of cycles by which it may make the pulse appear
 * early.
 */
function disturb(machine, axis, { rise, fall }, [u, v]) {
  const { stimulus } = machine.board;
  const pin = pins.INDEX[axis];
  const length = 10 + Math.round(u * (WIDTH - POLL - 10));
  const apart = 10 + Math.round((v * 4 - Math.floor(v * 4)) * 3 * WIDTH);
  switch (Math.floor(v * 4)) {
    case 0:
    case 1:
      stimulus.pulse(rise - apart - length, pin, length);
      return { text: `${length} cycles high, ${apart} before the pulse`, early: isBridged(length, apart) ? apart + length : 0 };
    case 2:
      stimulus.pulse(rise + apart, pin, length, 0);
      return { text: `${length} cycles low, ${apart} after the pulse came`, early: 0 };
    default:
      stimulus.pulse(fall + apart, pin, length);
      return { text: `${length} cycles high, ${apart} after the pulse went`, early: 0 };
  }
}
