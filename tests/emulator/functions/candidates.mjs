// The candidates, with format and range: the conversion of an argument to bits, and of bits to a result.
import { even, floats, logarithmic, pairs, turn } from './arguments.mjs';

const float = new DataView(new ArrayBuffer(8));
const f32Bits = (x) => (float.setFloat32(0, x), float.getUint32(0));
const f32 = (bits) => (float.setUint32(0, bits), float.getFloat32(0));
const u64 = (r) => (BigInt(r.r1) << 32n) | BigInt(r.r0);
const words = (x) => [Number(x & 0xffffffffn), Number(x >> 32n)];
const f64Words = (x) => (float.setFloat64(0, x), [float.getUint32(4), float.getUint32(0)]);
const f64 = (r) => (float.setUint32(0, r.r1), float.setUint32(4, r.r0), float.getFloat64(0));

function floorRoot(x) {
  let root = BigInt(Math.floor(Math.sqrt(Number(x))));
  while (root * root > x) root -= 1n;
  while ((root + 1n) * (root + 1n) <= x) root += 1n;
  return root;
}

/** Error of a result. Roots: relative; others: absolute, the worse of two results. */
const relative = (actual, exact) => Math.abs(actual - exact) / exact;
const off = (actual, exact) => Math.max(...actual.map((value, i) => Math.abs(value - exact[i])));

const root = (symbol, name, format, range, list, encode, decode, more = {}) => ({
  what: 'root', symbol, name, format, range,
  arguments: () => list(),
  words: encode,
  error: (x, r) => relative(decode(r, x), Math.sqrt(more.value?.(x) ?? Number(x))),
  ...more,
});

const normalised = (r) => r.r0 / 2 ** r.r1;
const isFloor = { exact: (x, r) => BigInt(r.r0) === floorRoot(x) };
const isNormalisedFloor = {
  exact: (x, r) => BigInt(r.r0) === floorRoot(x << BigInt(2 * r.r1)) && r.r0 >= 2 ** 31 && r.r1 < 32,
};
const fixedRoot = (symbol, name) =>
  root(symbol, name, 'I16F16', '2^-16 to 2^15', () => logarithmic(0, 31), (x) => [Number(x)], (r) => (r.r0 | 0) / 65536, {
    value: (x) => Number(x) / 65536,
  });

const TAU = 2 * Math.PI;
const sine = (symbol, name, format, range, radians, encode, decode) => ({
  what: 'sine, cosine', symbol, name, format, range,
  arguments: turn,
  words: (x) => [encode(x) >>> 0],
  error: (x, r) => off([decode(r.r0), decode(r.r1)], [Math.sin(radians(x)), Math.cos(radians(x))]),
});
const turnSine = (symbol, name, format, scale) =>
  sine(symbol, name, format, 'a turn', (x) => (x / 2 ** 32) * TAU, (x) => x, (bits) => (bits | 0) / scale);
const i4f28 = (x) => Math.round((x / 2 ** 32 - 0.5) * TAU * 2 ** 28);
const fixedSine = (symbol, name) =>
  sine(symbol, name, 'radians, I4F28', '−π to π', (x) => i4f28(x) / 2 ** 28, i4f28, (bits) => (bits | 0) / 2 ** 28);
const radiansF32 = (x) => Math.fround((x / 2 ** 32 - 0.5) * TAU);
const floatSine = (symbol, name) =>
  sine(symbol, name, 'radians, f32', '−π to π', radiansF32, (x) => f32Bits(radiansF32(x)), f32);

const Q30 = 2 ** 30;
/** Vectors as long as `length`, around the turn. The true angle is that of the rounded vector. */
const arctangent = (symbol, name, format, round, encode, decode) => ({
  what: 'arctangent', symbol, name, format, range: 'a turn',
  arguments: turn,
  words: (x) => vector(x, round).map((v) => encode(v) >>> 0),
  error: (x, r) => {
    const far = Math.abs(decode(r.r0) - Math.atan2(...vector(x, round)));
    return Math.min(far, Math.abs(TAU - far)); // π is −π
  },
});
const vector = (x, round) => [Math.sin, Math.cos].map((of) => round(of((x / 2 ** 32) * TAU)));
const rounded = (scale) => (v) => Math.round(v * scale) / scale;
const integers = (symbol, name, format, scale, decode) =>
  arctangent(symbol, name, format, rounded(scale), (v) => v * scale, decode);
const turnsOf = (bits) => ((bits | 0) / 2 ** 32) * TAU;
const q28 = (bits) => (bits | 0) / 2 ** 28;
const inverse = (symbol, name, format, argument, encode, decode) => ({
  what: '1/sqrt(1 − x)', symbol, name, format, range: '0 to 0.36',
  arguments: () => even(0.36),
  words: (x) => [encode(argument(x))],
  error: (x, r) => Math.abs(decode(r.r0) - 1 / Math.sqrt(1 - argument(x))),
});
const fixedInverse = (symbol, name) =>
  inverse(symbol, name, '30 fraction bits', (x) => Math.floor(x * Q30) / Q30, (x) => x * Q30, (bits) => bits / Q30);
const floatInverse = (symbol, name) => inverse(symbol, name, 'f32', Math.fround, f32Bits, f32);

const product = (symbol, name) => ({
  what: 'product', symbol, name, format: '30 fraction bits', range: '−1 to 1',
  arguments: pairs,
  words: ([a, b]) => [a >>> 0, b >>> 0],
  error: ([a, b], r) => Math.abs((r.r0 | 0) / Q30 - (a / Q30) * (b / Q30)),
  exact: ([a, b], r) => BigInt(r.r0 | 0) === (BigInt(a) * BigInt(b)) >> 30n,
});

/** Our own functions are marked: a check fails when they become slower. */
export const candidates = [
  root('root_cophase', 'cophase `root`', 'u64 → 32 significant bits', '1 to 2^64', () => logarithmic(0, 64), words,
    normalised, { ...isNormalisedFloor, ours: true }),
  root('root_cophase_isqrt', 'cophase `isqrt`', 'u64 → u32', '2^62 to 2^64', () => logarithmic(62, 64), words,
    (r) => r.r0, { ...isFloor, ours: true }),
  root('root_core_normalised', 'core `u64::isqrt`, normalised', 'u64 → 32 significant bits', '1 to 2^64',
    () => logarithmic(0, 64), words, normalised, isNormalisedFloor),
  root('root_core_u64', 'core `u64::isqrt`', 'u64 → u32', '2^62 to 2^64', () => logarithmic(62, 64), words,
    (r) => r.r0, isFloor),
  root('root_core_u32', 'core `u32::isqrt`', 'u32 → u16', '2^30 to 2^32', () => logarithmic(30, 32),
    (x) => [Number(x)], (r) => r.r0, isFloor),
  root('root_table', 'table of 193, straight lines', 'u32 → 17 significant bits', '2^30 to 2^32',
    () => logarithmic(30, 32), (x) => [Number(x)], (r) => r.r0 / 65536),
  fixedRoot('root_fixed_i16f16', 'fixed `sqrt`'),
  root('root_fixed_u32f32', 'fixed `sqrt`', 'U32F32', '2^-32 to 2^32', () => logarithmic(0, 64), words,
    (r) => Number(u64(r)) / 2 ** 32, { value: (x) => Number(x) / 2 ** 32 }),
  fixedRoot('root_fixed_sqrt_i16f16', 'fixed-sqrt `fast_sqrt`'),
  fixedRoot('root_fixed_analytics_i16f16', 'fixed_analytics `sqrt`'),
  fixedRoot('root_cordic_i16f16', 'cordic `sqrt`'),
  root('root_micromath_f32', 'micromath `sqrt`', 'f32', '2^-32 to 2^32', () => floats(-32, 32), (x) => [f32Bits(x)],
    (r) => f32(r.r0)),
  root('root_libm_f32', 'libm `sqrtf`', 'f32', '2^-32 to 2^32', () => floats(-32, 32), (x) => [f32Bits(x)],
    (r) => f32(r.r0)),
  root('root_libm_f64', 'libm `sqrt`', 'f64', '2^-32 to 2^32', () => floats(-32, 32), f64Words, (r) => f64(r)),

  { ...turnSine('sine_cophase', 'cophase `sine_cosine`', 'turns, 30 fraction bits', Q30), ours: true },
  turnSine('sine_table_nearest', 'table of 1,025, nearest', 'turns, 30 fraction bits', Q30),
  turnSine('sine_table_linear', 'table of 1,025, straight lines', 'turns, 30 fraction bits', Q30),
  turnSine('sine_table_linear_i64', 'the same, products in 64 bits', 'turns, 30 fraction bits', Q30),
  // Full scale is a little below 2^31: the amplitude that idsp's own tests measure against.
  turnSine('sine_idsp_table', 'idsp `cossin`', 'turns, 31 fraction bits', 2 ** 31 - 0.85 * 2 ** 15),
  turnSine('sine_idsp_cordic', 'idsp `cos_sin` (CORDIC)', 'turns, 31 fraction bits', 2147483000),
  fixedSine('sine_cordic_i4f28', 'cordic `sin_cos`'),
  fixedSine('sine_fixed_analytics_i4f28', 'fixed_analytics `sin_cos`'),
  floatSine('sine_micromath_f32', 'micromath `sin_cos`'),
  floatSine('sine_libm_f32', 'libm `sincosf`'),

  integers('arctangent_table', 'table of 257, straight lines', 'turns, 32 fraction bits', Q30, turnsOf),
  integers('arctangent_idsp', 'idsp `atan2`', 'turns, 32 fraction bits', Q30, turnsOf),
  integers('arctangent_cordic_i4f28', 'cordic `atan2`', 'radians, I4F28', 2 ** 28, q28),
  integers('arctangent_fixed_analytics_i4f28', 'fixed_analytics `atan2`', 'radians, I4F28', 2 ** 28, q28),
  arctangent('arctangent_micromath_f32', 'micromath `atan2`', 'radians, f32', Math.fround, f32Bits, f32),
  arctangent('arctangent_libm_f32', 'libm `atan2f`', 'radians, f32', Math.fround, f32Bits, f32),

  { ...fixedInverse('inverse_root_cophase', 'cophase `inverse_root_of_one_minus`'), ours: true },
  fixedInverse('inverse_root_newton_i64', 'series and Newton, products in 64 bits'),
  floatInverse('inverse_root_micromath_f32', 'micromath `invsqrt`'),
  floatInverse('inverse_root_libm_f32', 'libm 1 / `sqrtf`'),

  { ...product('product_cophase', 'cophase `multiply_q30`'), ours: true },
  product('product_i64', 'product in 64 bits'),
];
