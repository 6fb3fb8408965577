// Random scenes over all keys that cost the control tick time.
//
// A *genome* has one number from 0 to 1 for each property. So a scene can be drawn, and a scene that took long can be changed in
// some properties and kept in the others.

const GRAVITY = 9.80665;
const RADIUS_M = 0.012;
const LAMBDA = 0.3;

/** Pulses per second of one axis, as drawn at most: what the settings accept with the shortest pulse. */
const MAX_STEP_HZ = 900_000;

/** Steps per turn that a drawn crank has at most. */
const MAX_STEPS = 25_600;

/** Axes that leave the pins of the UART free. */
const UART_AXES = 4;

/** Share of the scenes that home slowly, so that their branches are in homing. */
const SLOW_HOMING_SHARE = 0.15;

/** Share of the cams whose axes follow tables. */
const TABLE_SHARE = 0.6;

/** A stream of numbers from 0 to 1 (mulberry32), the same for the same seed. */
export function random(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

const NAMES = [
  'kind', 'axes', 'speed', 'steps', 'stepPattern', 'gears', 'sensors', 'width', 'bands', 'bandPlace', 'acceleration', 'jerk', 'stopLimits', 'homing', 'trims',
  'trimRate', 'offsets', 'gain', 'slips', 'slipRate', 'prove', 'program', 'level', 'ramp', 'shape', 'reversed', 'drive', 'park', 'indexUs', 'link', 'override', 'followers', 'settle', 'limits', 'rate',
];

/** A genome: a number from 0 to 1 for each property. */
export const draw = (next) => Object.fromEntries(NAMES.map((name) => [name, next()]));

/** A genome with a few properties drawn anew. */
export function mutate(genome, next) {
  const changed = { ...genome };
  const count = 1 + Math.floor(next() * 4);
  for (let i = 0; i < count; i += 1) changed[NAMES[Math.floor(next() * NAMES.length)]] = next();
  return changed;
}

const pick = (items, at) => items[Math.min(items.length - 1, Math.floor(at * items.length))];
const between = (min, max, at) => min + (max - min) * at;
const logBetween = (min, max, at) => Math.exp(between(Math.log(min), Math.log(max), at));
const round = (value, digits = 4) => Number(value.toFixed(digits));
/** More numbers from one: the fraction of a multiple. */
const more = (at, number) => (at * (number * 7.31 + 13.7)) % 1;

/**
 * The scene of a genome, with what the bench plays beside it: { toml, transport: 'usb', 'uart' or null, slips: steps a second of each
 * crank, override: thousandths or null }.
 */
export function sceneOf(genome) {
  const g = genome;
  const axes = pick([2, 3, 4, 5, 6, 6, 6, 6], g.axes);
  const isCam = g.kind > 0.8;
  const speed = round(logBetween(20, 150, g.speed), 2);
  const motions = motionsOf(g, axes, isCam);
  const max = Math.max(...motions.map(({ ratio, gear }) => ratio * gear));
  const perTurn = Math.min(MAX_STEPS, (0.8 * MAX_STEP_HZ) / (speed * max));
  const steps = Math.max(200, Math.floor(logBetween(Math.min(800, perTurn / 2), perTurn, g.steps)));
  const distance = pick([0, 1, 1, 1, 2], g.stepPattern);
  const axis = motions.map(({ gearOf, follower }, number) => ({
    number,
    steps_per_turn: steps - Math.ceil(steps / 50) * (distance === 2 ? number >> 1 : distance * number),
    ...gearOf,
    ...follower,
    ...(follower.cam ? { index: false } : { index_deg: round(g.sensors < 0.7 ? 14.4 : between(-170, 170, more(g.sensors, number)), 1) }),
    trim_deg: g.trims < 0.4 ? 0 : round(between(-8, 8, more(g.trims, number)), 2),
    offset_deg: g.offsets < 0.7 || follower.cam ? 0 : round(between(-15, 15, more(g.offsets, number)), 2),
    reversed: pick([false, more(g.reversed, number) < 0.5, number % 2 === 1], g.reversed),
  }));
  const limits = limitsOf(g, speed);
  const toml = {
    name: 'search',
    fidelity: 'kinematic',
    ...(isCam ? camOf(g) : { machine: machineOf(g) }),
    control: { settle_s: g.settle < 0.9 ? 0.002 : 0.01, tick_hz: 10_000, park_deg: round(between(0, 359, g.park), 1) },
    limits,
    index: { width_us: round(logBetween(0.2, 15, g.indexUs), 1) },
    pulse: { width_ns: 288 },
    axes: {
      count: axes,
      drive: pick(['stepper', 'stepper', 'pulse-servo'], g.drive),
      steps_per_turn: steps,
      trim_limit_deg: 30,
      trim_rate_deg_per_s: round(logBetween(5, 360, g.trimRate), 1),
      index_width_deg: pick([0, 0, round(between(2, 40, g.width), 1)], g.width),
    },
    axis,
    drift: { warp_limit_deg: 89, common_limit_deg: 170, ...(isCam ? {} : { tilt_limit_mrad: 99 }) },
    correction: g.gain < 0.35 ? {} : { gain: round(between(0.1, 1, g.gain), 2), prove_wiring: g.prove < 0.25 && !isCam },
    program: programOf(g, speed, isCam),
  };
  if (g.limits > 0.8) Object.assign(toml.drift, { warp_limit_deg: 4, common_limit_deg: 10 }, isCam ? {} : { tilt_limit_mrad: 3 });
  const slips = axis.map((_, number) => (g.gain < 0.35 && g.slips < 0.5 ? 0 : Math.round(between(-1, 1, more(g.slips, number)) * logBetween(20, 600, g.slipRate))));
  return {
    toml,
    // The pins of the UART are those of the fifth axis.
    transport: pick([null, 'usb', 'usb', axes > UART_AXES ? 'usb' : 'uart'], g.link),
    slips: slips.map((rate, number) => (more(g.slips, number + 7) < 0.5 ? rate : 0)),
    override: g.override < 0.5 ? null : Math.round(between(300, 1000, more(g.override, 1))),
  };
}

function machineOf(g) {
  const common = { load_kg: 5, allow_commanded_tilt: true };
  return pick([
    { ...common, crank_radius_mm: 1000 * RADIUS_M, lambda: LAMBDA },
    { ...common, crank_radius_mm: 1000 * RADIUS_M, lambda: LAMBDA },
    { ...common, crank_radius_mm: 1000 * RADIUS_M, mechanism: 'scotch-yoke' },
    { ...common, mechanism: 'crank-rocker', screw_lead_mm: 30, crank_ratio: 0.4852094, coupler_ratio: 1.5402148, ground_ratio: 1.927919 },
  ], g.kind / 0.8);
}

/** Pushers on cam shafts whose axes have ratios, or on screws whose axes follow cam tables. */
function camOf(g) {
  const cam = { law: 'modified-sine', rise_mm: 24, rise_deg: 120, dwell_deg: 135, return_deg: 105 };
  if (g.followers < TABLE_SHARE) return { cam: { ...cam, screw_lead_mm: 20 }, ...tables() };
  return { cam };
}

function tables() {
  return {
    cam_table: [
      { name: 'lobe', segment: [{ deg: 120, turns: 1.2 }, { deg: 135, turns: 0 }, { deg: 105, turns: -1.2 }], max_speed_hz: 1000, max_acceleration_hz_per_s: 1e9 },
      { name: 'indexer', net_turns: 1, segment: [{ deg: 150, turns: 0.4 }, { deg: 150, turns: 0.6 }], max_speed_hz: 1000, max_acceleration_hz_per_s: 1e9 },
    ],
  };
}

/** For each axis { ratio: axis turns a master turn at most, gear: motor turns a crank turn, gearOf, follower: keys }. */
function motionsOf(g, axes, isCam) {
  const geared = g.gears < 0.45 ? 0 : g.gears < 0.75 ? axes : Math.ceil(more(g.gears, 3) * axes);
  return Array.from({ length: axes }, (_, number) => {
    const gear = number < geared ? pick([[57, 11], [355, 113], [20, 36], [3, 1], [997, 1000]], more(g.gears, number + 11)) : [1, 1];
    const gearOf = gear[0] === gear[1] ? {} : { gear };
    let follower = {};
    let ratio = 1;
    if (isCam) {
      const at = more(g.followers, number);
      if (g.followers < TABLE_SHARE) {
        follower = { cam: at < 0.5 ? 'lobe' : 'indexer', cam_shift_deg: g.followers < 0.4 ? 30 * number : 0 };
        ratio = 5;
      } else {
        const of = pick([[1, 1], [2, 3], [7, 5], [355, 226]], more(g.followers, number + 5));
        follower = { ratio: of };
        ratio = of[0] / of[1];
      }
    }
    return { ratio, gear: gear[0] / gear[1], gearOf, follower };
  });
}

/** Bands leave room at both ends, for homing and for the top of the program. */
function limitsOf(g, speed) {
  const count = pick([0, 1, 2, 3, 4, 4, 4], g.bands);
  const from = 10.5;
  const room = (0.95 * speed - from) / Math.max(count, 1);
  const band = Array.from({ length: room < 0.5 ? 0 : count }, (_, number) => {
    const begin = from + room * (number + between(0.05, 0.4, more(g.bandPlace, number)));
    return { from_hz: round(begin, 2), to_hz: round(begin + room * between(0.1, 0.5, more(g.bandPlace, number + 9)), 2) };
  });
  const acceleration = round(logBetween(200, 3000, g.acceleration), 0);
  const jerk = round(acceleration * logBetween(8, 400, g.jerk), 0);
  const scale = pick([1, 1, 1, 3], g.stopLimits);
  return {
    speed_hz: speed,
    acceleration_hz_per_s: acceleration,
    jerk_hz_per_s2: jerk,
    ...(scale === 1 ? {} : { stop_acceleration_hz_per_s: scale * acceleration, stop_jerk_hz_per_s2: scale * jerk }),
    // In slow homing, trims that move fast leave their group before the machine runs.
    homing_speed_hz: round(g.homing < SLOW_HOMING_SHARE ? logBetween(0.1, 2, g.homing / SLOW_HOMING_SHARE) : between(8, 10, g.homing), 2),
    ...(band.length === 0 ? {} : { band }),
  };
}

/** Levels as fractions of the greatest one, up and down. */
function programOf(g, speed, isCam) {
  // A crank-rocker and a cam with these lengths have a smaller amplitude at the same speed than the crank; `fitted` lowers it.
  const max = (RADIUS_M * (2 * Math.PI * speed) ** 2 * (isCam ? 1 : 1 + LAMBDA)) / GRAVITY;
  const count = pick([1, 2, 3, 6], g.program);
  const shape = g.shape < 0.6 ? 'smooth' : 'linear';
  return Array.from({ length: count }, (_, number) => ({
    amax_g: round(max * between(number % 2 === 0 ? 0.5 : 0.05, number % 2 === 0 ? 0.95 : 0.4, more(g.level, number)), 4),
    ramp_s: round(between(0.05, 0.3, more(g.ramp, number)), 3),
    hold_s: pick([0, 0.01, 0.05], more(g.ramp, number + 4)),
    shape,
  }));
}

/** The same scene with a program of lower levels. */
export function lower(toml, by) {
  return { ...toml, program: toml.program.map((entry) => ({ ...entry, amax_g: round(entry.amax_g * by, 5) })) };
}
