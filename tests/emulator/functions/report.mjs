// Measured rows as the CSV of docs/emulated-functions.csv and the tables of docs/functions.md.

/** Rows as CSV, their keys as header. */
export function csv(rows) {
  const quoted = (v) => (/[",]/.test(String(v)) ? `"${String(v).replaceAll('"', '""')}"` : String(v));
  const lines = rows.map((row) => Object.values(row).map(quoted).join(','));
  return `${[Object.keys(rows[0]).join(','), ...lines].join('\n')}\n`;
}

/** Reads the output of `csv` into rows of strings. */
export function parsed(text) {
  const fields = (line) =>
    [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map((m) => (m[1] ?? m[2]).replaceAll('""', '"'));
  const [names, ...lines] = text.trim().split('\n').map(fields);
  return lines.map((values) => Object.fromEntries(names.map((name, i) => [name, values[i]])));
}

/** Rows as Markdown, a table for each function. */
export function markdown(rows) {
  const lines = [];
  for (const what of new Set(rows.map((row) => row.function))) {
    lines.push('', `| ${what} | format | error: mean | rms | max | cycles: min | mean | max | bytes | |`);
    lines.push('| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |');
    for (const r of rows.filter((row) => row.function === what)) {
      const errors = [r.error_mean, r.error_rms, r.error_max].map((e) => e.replace('e+0', '').replace('e-', 'e−'));
      const cycles = [r.cycles_min, Math.round(r.cycles_mean), r.cycles_max].map((c) => c.toLocaleString('en'));
      const cells = [r.candidate, `${r.format}, ${r.range}`, ...errors, ...cycles, r.bytes.toLocaleString('en'), r.notes];
      lines.push(`| ${cells.join(' | ')} |`);
    }
  }
  return lines.join('\n');
}
