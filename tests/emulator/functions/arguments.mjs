// The arguments that candidates are called with. They are the same on every run and spread over the whole range,
// and include its ends, powers of two and their neighbours.

const COUNT = 2000;

/** 64 bits that depend on `i` alone (splitmix64). */
function mixed(i) {
  const mask = (1n << 64n) - 1n;
  let z = (BigInt(i) * 0x9e3779b97f4a7c15n + 0x2013_0412n) & mask;
  z = ((z ^ (z >> 30n)) * 0xbf58476d1ce4e5b9n) & mask;
  z = ((z ^ (z >> 27n)) * 0x94d049bb133111ebn) & mask;
  return z ^ (z >> 31n);
}

/** Integers from 2^low to 2^high − 1, as many in each octave. */
export function logarithmic(low, high) {
  const values = new Set();
  for (let i = 0; i < COUNT; i++) {
    const octave = BigInt(low + Math.floor((i * (high - low)) / COUNT));
    values.add((1n << octave) + (mixed(i) >> (64n - octave)));
  }
  for (let octave = low; octave <= high; octave++) {
    for (const near of [-1n, 0n, 1n]) values.add((1n << BigInt(octave)) + near);
  }
  // Squares and their neighbours: where a floor changes
  for (let i = 0; i < COUNT / 4; i++) {
    const root = mixed(i + COUNT) >> BigInt(64 - Math.ceil(high / 2));
    for (const near of [-1n, 0n, 1n]) values.add(root * root + near);
  }
  return [...values].filter((x) => x >= 1n << BigInt(low) && x < 1n << BigInt(high));
}

/** Floats from 2^low to 2^high, as many in each octave. */
export function floats(low, high) {
  return logarithmic(23, 23 + high - low).map((x) => Math.fround(Number(x) * 2 ** (low - 23)));
}

/** Angles around the turn, 2^32 to the turn. */
export function turn() {
  const values = new Set();
  const count = 4099; // prime: falls everywhere between a table's entries
  for (let i = 0; i < count; i++) values.add(Math.floor((i * 2 ** 32) / count));
  for (let i = 0; i < 16; i++) for (const near of [-1, 0, 1]) values.add((i * 2 ** 28 + near) >>> 0);
  return [...values];
}

/** From 0 to `end`, evenly. */
export function even(end) {
  return Array.from({ length: COUNT + 1 }, (_, i) => (end * i) / COUNT);
}

/** Pairs from −1 to 1. */
export function pairs() {
  const values = [];
  const one = 2 ** 30;
  for (const a of [-one, -1, 0, 1, one]) for (const b of [-one, -1, 0, 1, one]) values.push([a, b]);
  for (let i = 0; i < COUNT; i++) {
    const bits = mixed(i);
    values.push([Number(bits >> 33n) - one, Number(bits & 0x7fffffffn) - one]);
  }
  return values;
}
