// Test of the page with the simulated controller.

import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { contact } from './contact.mjs';
import { HERE, check, drawn, enabled, open, press, scope, state } from './harness.mjs';
import { keyboard } from './keyboard.mjs';
import { limitOfTilt, limitsOfSpeed } from './limits.mjs';
import { sizes } from './sizes.mjs';
import { themes } from './themes.mjs';
import { triggers } from './triggers.mjs';

export async function simulated(chrome) {
  const server = await scope('--to', `sim:${join(HERE, 'scene.toml')}`);
  try {
    const page = await open(chrome, server.url);
    await programRuns(page);
    await limitsOfSpeed(page);
    await faultIsNamed(page);
    await limitOfTilt(page);
    await csvReadsBack(page);
    await faultIsReset(page);
    await triggers(page);
    await keyboard(page);
    await secondPageWatches(chrome, server.url);
    await page.context().close();
    await sizes(chrome, server.url);
    await themes(chrome, server.url);
  } finally {
    await server.stop();
  }
  await contact(chrome);
}

async function programRuns(page) {
  check('start is refused with a reason before control', (await page.getAttribute('[data-action=start]', 'title'))?.includes('control'));
  await press(page, 'control');
  await enabled(page, 'arm');
  await page.locator('#editor textarea').fill((await readFile(join(HERE, 'scene.toml'), 'utf8')).replace('amax_g = 4', 'amax_g = 3'));
  await page.click('#editor button:text-matches("^Load")');
  await page.waitForFunction(() => /Loaded/.test(document.getElementById('editor').textContent));
  check('an edited program is loaded', true);
  await press(page, 'arm');
  await enabled(page, 'start');
  await press(page, 'start');
  await state(page, 'run');
  await page.waitForFunction(() => {
    const { history } = globalThis.cophaseScope.parts;
    return history.value('amax_commanded_mps2', history.end - 1) > 2.99 * 9.80665;
  });
  const [, requested, commanded] = await drawn(page, 'amplitude');
  const last = (column) => column.filter((value) => value !== null).at(-1);
  check('the plots show the edited amplitude of 3 g', Math.abs(last(commanded) - 3) < 0.02 && Math.abs(last(requested) - 3) < 0.02,
    `requested ${last(requested).toFixed(3)} g, commanded ${last(commanded).toFixed(3)} g`);
  const before = await drawn(page, 'speed');
  await page.waitForTimeout(300);
  const after = await drawn(page, 'speed');
  check('the plots move', after[0].at(-1) > before[0].at(-1), `${before[0].at(-1).toFixed(3)} s to ${after[0].at(-1).toFixed(3)} s`);
}

async function faultIsNamed(page) {
  await page.selectOption('#faults [name=kind]', { label: await page.locator('#faults option', { hasText: /^slip/ }).textContent() });
  await page.selectOption('#faults [name=axis]', '2');
  await page.click('#faults [type=submit]');
  await state(page, 'fault');
  await page.waitForFunction(() => !document.getElementById('fault').hidden);
  const text = await page.textContent('#fault');
  check('an injected slip of axis 2 is named by the controller', /slip/.test(text) && /2/.test(text), text);
}

async function csvReadsBack(page) {
  await page.click('#pause');
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save-csv')]);
  const lines = (await readFile(await download.path(), 'utf8')).trimEnd().split('\n');
  const names = lines[0].split(',');
  const rows = lines.slice(1).map((line) => line.split(','));
  const expected = await page.evaluate(() => {
    const { view } = globalThis.cophaseScope.parts;
    const { history } = view;
    const [first, end] = [history.find(view.from), history.end];
    const pick = Array.from({ length: 40 }, (_, k) => first + Math.floor((k * (end - 1 - first)) / 39));
    return {
      count: end - first,
      columns: history.names.length,
      missing: history.missing,
      samples: pick.map((i) => ({ row: i - first, values: history.columns.map((column) => column[i & history.mask]) })),
    };
  });
  check('the CSV has a row for each sample of the window', rows.length === expected.count, `${rows.length} rows`);
  check('the CSV has all columns', names.length === expected.columns + 3 && rows.every((row) => row.length === names.length), `${names.length} columns`);
  const times = rows.map((row) => Number(row[0]));
  check('the time of the CSV is monotone', times.every((t, i) => i === 0 || t > times[i - 1]));
  const same = expected.samples.every(({ row, values }) =>
    values.every((value, c) => {
      const cell = rows[row][c + 3];
      return Number.isNaN(value) ? cell === '' : Math.fround(Number(cell)) === Math.fround(value);
    }));
  check('values of the CSV are those plotted', same);
  const ticks = rows.map((row) => Number(row[1]));
  const gaps = ticks.filter((tick, i) => i > 0 && tick !== ticks[i - 1] + 1).length;
  check('no sample is missing', gaps === 0 && expected.missing === 0, `${expected.missing} missing`);
}

async function faultIsReset(page) {
  await press(page, 'reset');
  await state(page, 'idle');
  check('a reset leaves the fault state', await page.isHidden('#fault'));
  // The crank that slipped is beyond the homing range.
  await press(page, 'restart');
  await page.waitForFunction(() => globalThis.cophaseScope.parts.history.now < 2);
  check('a restart begins the simulation anew', await page.locator('#event-list li').count() === 0);
}

async function secondPageWatches(chrome, url) {
  const page = await open(chrome, url);
  await page.waitForSelector('[data-action=control][aria-disabled=true]');
  await page.click('[data-action=control]', { force: true });
  const text = await page.textContent('#message');
  check('a second page says who has control', /browser \d+ \(127\.0\.0\.1:\d+\) has control/.test(text), text);
  check('a second page has the events so far', await page.locator('#event-list li').count() > 3);
  check('a second page may stop', (await page.getAttribute('[data-action=stop-now]', 'aria-disabled')) === 'false');
  await page.context().close();
}
