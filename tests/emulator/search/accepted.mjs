// Drawn scenes that the board accepts, each at the highest tick rate that it takes.

import { stringify } from 'smol-toml';
import { convert } from '../bench/host.mjs';
import { lower, sceneOf } from './draw.mjs';

/** Number of scenes, if the environment has no other. */
export const countOr = (usual) => Number(process.env.COPHASE_SEARCH || usual);

/** The seed of the first scene. */
export const SEED = Number(process.env.COPHASE_SEED || 1);
if (!(countOr(1) > 0) || !Number.isInteger(SEED)) throw new Error('COPHASE_SEARCH is a number of scenes, such as 200, and COPHASE_SEED a whole number');

/** The settings accept no higher rate. */
const MAX_HZ = 10_000;

/** Scenes that are drawn for one that is accepted. */
const MAX_TRIES = 40;

/** A drawn scene, changed by `change`, at the highest rate that the board accepts: { genome, drawn, settings, bound }. */
export function accepted(genomeOf, change = () => {}) {
  const refusals = [];
  for (let tries = 0; tries < MAX_TRIES; tries += 1) {
    const genome = genomeOf();
    const drawn = sceneOf(genome);
    change(drawn.toml);
    for (let { toml } = drawn; ; toml = lower(toml, 0.8)) {
      const converted = atRate(toml, genome.rate);
      if (converted.settings) return { genome, drawn: { ...drawn, toml }, ...converted };
      refusals.push(converted.refused.split('\n')[0]);
      // Which level a mechanism reaches at the greatest speed is the host's to say.
      if (!/program/.test(converted.refused) || toml.program[0].amax_g < 0.01) break;
    }
  }
  throw new Error(`of ${MAX_TRIES} scenes none is accepted:\n${[...new Set(refusals)].join('\n')}`);
}

/** Rates of which a tick has whole microseconds. */
const RATES = [500, 625, 800, 1000, 1250, 1600, 2000, 2500, 3125, 4000, 5000, 6250, 8000, 10_000];

/** Share of the scenes at the highest rate that the board accepts. At lower ones a tick has more edges. */
const AT_HIGHEST = 0.7;

/** Sets the highest rate that the board accepts, or a lower one; gives the settings and the bound, or the refusal. */
function atRate(toml, at) {
  const highest = atMost(toml);
  if (highest.settings === undefined || at < AT_HIGHEST) return highest;
  const lower = RATES.filter((hz) => hz <= toml.control.tick_hz);
  toml.control.tick_hz = lower[Math.floor(((at - AT_HIGHEST) / (1 - AT_HIGHEST)) * lower.length)];
  return convert({ text: stringify(toml) });
}

/** Sets the highest rate that the board accepts; gives the settings and the bound, or the refusal. */
export function atMost(toml) {
  toml.control.tick_hz = MAX_HZ;
  const converted = convert({ text: stringify(toml) });
  if (converted.maxHz === undefined) return converted;
  toml.control.tick_hz = converted.maxHz;
  return convert({ text: stringify(toml) });
}
