// Plots: their signals, with the column, the name, and the colour of each. `--trace-*` are colours of style.css. Scales with
// `min` show at least this value on both sides of zero, so that noise does not fill the plot. `marks` are limits and forbidden
// bands.

const G_PER_MPS2 = 1 / 9.80665;

/** Returns the unit of a column, and the factor that converts its values to this unit. */
export function unitOf(column) {
  if (column.endsWith('_mps2')) return { unit: 'g', scale: G_PER_MPS2, digits: 2 };
  if (column.startsWith('speed')) return { unit: 'rev/s', scale: 1, digits: 3 };
  if (column.includes('_deg')) return { unit: '°', scale: 1, digits: 3 };
  if (column.endsWith('_mrad')) return { unit: 'mrad', scale: 1, digits: 3 };
  return { unit: '', scale: 1, digits: 3 };
}

const text = (value) => String(+value.toPrecision(3));

/** A band of values, with its name, or a limit if both edges are equal. */
const band = (from, to, unit) => ({ name: `band ${text(from)} to ${text(to)} ${unit}`, from, to });
const limit = (value, name) => ({ name, from: value, to: value });

/** Returns the plots of a machine with a number of axes and with limits, from top to bottom. */
export function plots(axes, limits) {
  const { speed, tilt_mrad: tilt } = limits;
  const bands = (unit, value) => limits.bands.map(([from, to]) => band(value(from), value(to), unit));
  const g = ({ amax_mps2 }) => amax_mps2 * G_PER_MPS2;
  const hz = ({ speed_hz }) => speed_hz;
  return [
    {
      id: 'amplitude',
      title: 'Amplitude amax',
      unit: 'g',
      share: 3,
      marks: [limit(g(speed), `limit ${text(g(speed))} g`), ...bands('g', g)],
      signals: [
        { column: 'amax_requested_mps2', name: 'requested', color: '--trace-requested', dash: [6, 4] },
        { column: 'amax_commanded_mps2', name: 'commanded', color: '--trace-commanded' },
        { column: 'amax_actual_mps2', name: 'actual, from the speed over the last turn', short: 'actual', color: '--trace-actual' },
      ],
    },
    {
      id: 'speed',
      title: 'Speed',
      unit: 'rev/s',
      share: 2,
      marks: [limit(hz(speed), `limit ${text(hz(speed))} rev/s`), ...bands('rev/s', hz)],
      signals: [
        { column: 'speed_hz', name: 'commanded', color: '--trace-commanded' },
        { column: 'speed_actual_hz', name: 'actual, over the last turn', short: 'actual', color: '--trace-actual' },
      ],
    },
    {
      id: 'phase-error',
      title: 'Phase error',
      unit: '°',
      min: 0.1,
      share: 2,
      marks: [],
      signals: Array.from({ length: axes }, (_, i) => ({
        column: `phase_error_deg_${i}`,
        name: `axis ${i}`,
        color: `--axis-${i}`,
      })),
    },
    {
      id: 'tilt',
      title: 'Tilt',
      unit: 'mrad',
      min: 0.1,
      share: 2,
      marks: tilt === null ? [] : [limit(tilt, `limit ±${text(tilt)} mrad`), limit(-tilt)],
      signals: [
        { column: 'tilt_x_mrad', name: 'along x', color: '--trace-x' },
        { column: 'tilt_y_mrad', name: 'along y', color: '--trace-y' },
      ],
    },
  ];
}
