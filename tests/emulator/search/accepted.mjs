// Drawn scenes that the board accepts, each at the highest tick rate that it takes.

import { stringify } from 'smol-toml';
import { convert } from '../bench/host.mjs';
import { lower, sceneOf } from './draw.mjs';

/** Number of scenes, and the seed of the first. */
export const COUNT = Number(process.env.COPHASE_SEARCH || 8);
export const SEED = Number(process.env.COPHASE_SEED || 1);
if (!(COUNT > 0) || !Number.isInteger(SEED)) throw new Error('COPHASE_SEARCH is a number of scenes, such as 200, and COPHASE_SEED a whole number');

/** The settings accept no higher rate. */
const MOST_HZ = 10_000;

/** Scenes that are drawn for one that is accepted. */
const MOST_TRIES = 40;

/** A drawn scene, changed by `change`, at the highest rate that the board accepts: { genome, drawn, settings, bound }. */
export function accepted(genomeOf, change = () => {}) {
  const refusals = [];
  for (let tries = 0; tries < MOST_TRIES; tries += 1) {
    const genome = genomeOf();
    const drawn = sceneOf(genome);
    change(drawn.toml);
    for (let { toml } = drawn; ; toml = lower(toml, 0.8)) {
      const converted = atMost(toml);
      if (converted.settings) return { genome, drawn: { ...drawn, toml }, ...converted };
      refusals.push(converted.refused.split('\n')[0]);
      // Which level a mechanism reaches at the greatest speed is the host's to say.
      if (!/program/.test(converted.refused) || toml.program[0].amax_g < 0.01) break;
    }
  }
  throw new Error(`of ${MOST_TRIES} scenes none is accepted:\n${[...new Set(refusals)].join('\n')}`);
}

/** Sets the highest rate that the board accepts; gives the settings and the bound, or the refusal. */
export function atMost(toml) {
  toml.control.tick_hz = MOST_HZ;
  const converted = convert({ text: stringify(toml) });
  if (converted.mostHz === undefined) return converted;
  toml.control.tick_hz = converted.mostHz;
  return convert({ text: stringify(toml) });
}
