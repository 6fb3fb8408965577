// Summary of a preview as text.

import { STATES } from './preview.js';

const GRAVITY = 9.80665;
const TURN = 2 * Math.PI;

/** Returns the text of a number with three digits. */
export const digits = (value) => (value === 0 ? '0' : String(Number(value.toPrecision(3))));

/** Returns a duration as text, such as 57 s, 2 min 5 s or 3 h 0 min. */
export function duration(seconds) {
  if (seconds < 60) return `${digits(seconds)} s`;
  const whole = Math.round(seconds);
  const [h, min, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return h ? `${h} h ${min} min` : `${min} min ${s} s`;
}

/** Returns the largest value of a channel. */
export function max(rows, channel) {
  let max = 0;
  for (let i = 0; i < rows.length; i++) max = Math.max(max, rows.high(i, channel), -rows.low(i, channel));
  return max;
}

/** Returns true if a channel is set in any row. */
const ever = (rows, channel) => max(rows, channel) > 0;

/** Returns the terms and descriptions of a summary. */
export function summarise(scene, rows) {
  const amplitude = (channel) => {
    const mps2 = max(rows, channel);
    return `${digits(mps2 / GRAVITY)} g (${digits(mps2)} m/s²)`;
  };
  const speed = max(rows, 'speed_rad_s');
  const acceleration = max(rows, 'acceleration_rad_s2');
  const active = [
    ['is_lagging', 'the speed lags, as the acceleration is limited'],
    ['is_held_at_band', 'a level lies in a forbidden band, and the nearer edge is held'],
    ['is_crossing_band', 'a forbidden band is crossed'],
  ].filter(([channel]) => ever(rows, channel));
  const terms = [
    ['Program', duration(scene.program_s)],
    ['With homing and parking', ending(scene)],
    ['Greatest amplitude requested', amplitude('requested_mps2')],
    ['Greatest amplitude commanded', amplitude('commanded_mps2')],
    ['Greatest speed', `${digits(speed / TURN)} rev/s (${digits(speed)} rad/s)`],
    ['Greatest acceleration', `${digits(acceleration / TURN)} rev/s² (${digits(acceleration)} rad/s²)`],
    ['Limits', active.map(([, words]) => words).join('; ') || 'none takes effect'],
  ];
  return terms.map(([term, description]) => {
    const group = document.createElement('div');
    const [dt, dd] = [document.createElement('dt'), document.createElement('dd')];
    dt.textContent = term;
    dd.textContent = description;
    group.append(dt, dd);
    return group;
  });
}

function ending({ previewed_s, expected_s, ended }) {
  if (ended.is_cut_off) return `about ${duration(expected_s)}; the first ${duration(previewed_s)} are shown`;
  if (ended.fault) return `${duration(previewed_s)}; it ends in the fault ${ended.fault}`;
  const state = STATES.includes(ended.state) && ended.state !== 'parked' ? `; the last state is ${ended.state}` : '';
  return `${duration(previewed_s)}${state}`;
}
