// Samples as files: CSV with all columns, VCD with state, flags and step counts.

/** Returns the samples of a window as CSV. Values are those of the plots' samples, in the units of the column names. */
export function csv(history, from, to, states) {
  const rows = [['t_s', 'tick', 'state', ...history.names].join(',')];
  for (let i = history.find(from); i < history.end && history.time(i) <= to; i++) {
    const values = history.columns.map((column) => text(column[i & history.mask]));
    const state = states[history.value('state_code', i)] ?? '';
    rows.push([history.time(i), history.ticks[i & history.mask], state, ...values].join(','));
  }
  return `${rows.join('\n')}\n`;
}

/** Returns the shortest text that reads back as the same 32-bit float. Returns an empty text if the value is not a number. */
function text(value) {
  if (Number.isNaN(value)) return '';
  if (Math.fround(value) !== value) return String(value);
  for (let digits = 6; digits < 9; digits++) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return String(short);
  }
  return String(Number(value.toPrecision(9)));
}

/**
 * Returns state, flags and step counts of a window as VCD. A change has the time of its tick, because edges within a tick are
 * not part of the samples.
 */
export function vcd(history, from, to) {
  const names = history.names.filter((name) => ['state_code', 'flags', 'override_permille'].includes(name) || name.startsWith('steps'));
  const bits = (name) => (name.startsWith('steps') ? 48 : 16);
  const id = (i) => String.fromCharCode(33 + i);
  const lines = [
    '$comment Counts at the end of each tick; edges within a tick are not sampled. $end',
    '$timescale 1 us $end',
    '$scope module cophase $end',
    ...names.map((name, i) => `$var integer ${bits(name)} ${id(i)} ${name} $end`),
    '$upscope $end',
    '$enddefinitions $end',
  ];
  const last = names.map(() => undefined);
  for (let i = history.find(from); i < history.end && history.time(i) <= to; i++) {
    const changes = names.flatMap((name, n) => {
      const value = history.value(name, i);
      if (value === last[n]) return [];
      last[n] = value;
      return [`b${BigInt.asUintN(bits(name), BigInt(value)).toString(2)} ${id(n)}`];
    });
    if (changes.length > 0) {
      lines.push(`#${Math.round(history.time(i) * 1e6)}`, ...changes);
    }
  }
  return `${lines.join('\n')}\n`;
}

/** Lets the user save a text as a file. */
export function download(name, text, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
