// The program editor alone, in headless Chromium.
//
//     npm ci && node editor.mjs [--screenshots FOLDER]
//
// Types into the editor like a user. A mistake appears at its line, a valid program changes the curve, and a program of many
// hours does not delay typing. Prints each check and the time from a key to its curve.

import assert from 'node:assert/strict';
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { chromium } from 'playwright-core';

const PAGE = fileURLToPath(new URL('../page/', import.meta.url));
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };
/** The policy of `cophase scope`, except for the socket. The page's own frame is in editor.html. */
const POLICY = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; connect-src 'self'";
/** Number of keys whose times are measured. */
const KEYS = 40;

const { screenshots } = parseArgs({ options: { screenshots: { type: 'string' } } }).values;

/** Serves the page's folder on loopback. */
function serve() {
  const server = http.createServer((request, response) => {
    const file = path.join(PAGE, path.basename(new URL(request.url, 'http://localhost').pathname));
    if (!fs.existsSync(file)) return response.writeHead(404).end();
    response.setHeader('Content-Type', TYPES[path.extname(file)] ?? 'text/plain');
    response.setHeader('Content-Security-Policy', POLICY);
    return response.end(fs.readFileSync(file));
  });
  return new Promise((resolve) => {
    server.listen(0, '127.0.0.1', () => resolve(server));
  });
}

function executable() {
  const paths = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  const found = paths.find((file) => file && fs.existsSync(file));
  if (found) return found;
  console.error('chromium is missing: install it (Debian: apt-get install chromium), or set CHROMIUM to its path');
  return process.exit(2);
}

const server = await serve();
const browser = await chromium.launch({ executablePath: executable(), args: ['--no-sandbox', '--disable-gpu'] });
const problems = [];

/** Opens the page with the editor, and waits until its first preview is drawn. */
async function open(options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('console', (line) => line.type() === 'error' && problems.push(line.text()));
  await page.addInitScript(() => {
    globalThis.previews = [];
    globalThis.longTasks = [];
    document.addEventListener('preview', ({ detail }) => globalThis.previews.push(detail), true);
    new PerformanceObserver((list) => globalThis.longTasks.push(...list.getEntries().map(({ duration }) => duration))).observe({
      type: 'longtask',
    });
  });
  await page.goto(`http://127.0.0.1:${server.address().port}/editor.html`);
  await page.waitForFunction(() => globalThis.previews.length > 0);
  return page;
}

/** Carries out an action, and waits for the preview that follows. */
async function previewAfter(page, action) {
  const before = await page.evaluate(() => globalThis.previews.length);
  await action();
  await page.waitForFunction((before) => globalThis.previews.length > before, before);
  return page.evaluate(() => {
    const { answer, ms } = globalThis.previews.at(-1);
    return { answer, ms };
  });
}

/** Puts the caret behind the first occurrence of a text in the editor. */
const caretBehind = (page, text) =>
  page.evaluate((text) => {
    const area = document.querySelector('textarea');
    const at = area.value.indexOf(text) + text.length;
    area.focus();
    area.setSelectionRange(at, at);
  }, text);

const curve = (page) => page.locator('.pe-commanded').first().getAttribute('d');
const checks = [];
const check = (what, test) => checks.push({ what, test });

check('the scene at the beginning has no mistakes, curves and a summary', async () => {
  const page = await open();
  assert.equal(await page.locator('.pe-mistakes li').count(), 0);
  assert.match(await curve(page), /^M.{1000}/);
  assert.match(await page.locator('.pe-summary').innerText(), /Greatest speed\s+\d+.* rev\/s/);
  assert.match(await page.locator('.pe-plot').textContent(), /limit 60 rev\/s/);
  assert.match(await page.locator('.pe-plot').textContent(), /band 25 to 29 rev\/s/);
});

check('a mistake appears at its line, and goes', async () => {
  const page = await open();
  const before = await curve(page);
  await caretBehind(page, 'amax_g = 70');
  const { answer } = await previewAfter(page, () => page.keyboard.press('0'));
  const line = await page.evaluate(() => document.querySelector('textarea').value.split('\n').indexOf('amax_g = 700') + 1);
  assert.deepEqual(answer.mistakes.map((mistake) => mistake.line), [line]);
  assert.match(answer.mistakes[0].text, /^program\[1\]\.amax_g \(2nd \[\[program\]\] entry\): /);
  const note = page.locator(`.pe-copy .has-mistake[data-line="${line}"]`);
  assert.ok((await note.innerText()).includes(answer.mistakes[0].text), 'the mistake is at its line');
  assert.equal(await page.locator('.pe-numbers .has-mistake').innerText(), String(line));
  // Text and copy must coincide. Otherwise the mark is at another line.
  const [area, copy] = await page.evaluate(() => ['.pe-area', '.pe-copy'].map((name) => {
    const element = document.querySelector(name);
    return { width: element.clientWidth, font: getComputedStyle(element).font, top: element.getBoundingClientRect().top, height: element.scrollHeight };
  }));
  assert.deepEqual([copy.font, copy.top], [area.font, area.top]);
  assert.ok(Math.abs(copy.height - area.height) < 20, `${copy.height} and ${area.height} high`);
  assert.ok(await page.getByRole('button', { name: 'Load' }).isDisabled());
  assert.equal(await curve(page), before, 'the last curve remains');
  await page.getByRole('button', { name: `Line ${line}` }).press('Enter');
  const caret = await page.evaluate(() => document.querySelector('textarea').value.slice(0, document.querySelector('textarea').selectionStart).split('\n').length);
  assert.equal(caret, line, 'the button leads to the line');
  await caretBehind(page, 'amax_g = 700');
  await previewAfter(page, () => page.keyboard.press('Backspace'));
  assert.equal(await page.locator('.has-mistake').count(), 0);
  assert.ok(await page.getByRole('button', { name: 'Load' }).isEnabled());
});

/** Replaces the first occurrence of a text in the editor, as pasting does. */
async function paste(page, text, pasted) {
  await page.evaluate((text) => {
    const area = document.querySelector('textarea');
    const at = area.value.indexOf(text);
    area.focus();
    area.setSelectionRange(at, at + text.length);
  }, text);
  await page.keyboard.insertText(pasted);
}

/** Text as other programs write it: what it replaces, and what is pasted. */
const PASTED = [
  ['amax_g = 15', 'amax_g = \u221215'],
  ['amax_g = 15', 'amax_g = \u201315'],
  ['amax_g = 15', 'amax_g =\u00a015'],
  ['amax_g = 15', 'amax_g = \uff11\uff15'],
  ['name = "alone"', 'name = \u201calone\u201d'],
  ['load_kg = 8', 'load_kg = 18 kg'],
  ['speed_hz = 60', 'speed_hz = 60,5'],
  ['from_hz = 25, to_hz = 29 }]', 'from_hz = 25, to_hz = 29, }, ]; # \u2028'],
  ['from_hz = 25, to_hz', 'from_hz = 25,5, to_hz'],
  ['[{ from_hz = 25', '[{ from_hz = \u221225'],
];

check('pasted text stays as it is, and its mistake is at its line', async () => {
  const page = await open();
  const before = await page.locator('textarea').inputValue();
  for (const [text, pasted] of PASTED) {
    const { answer } = await previewAfter(page, () => paste(page, text, pasted));
    const now = await page.locator('textarea').inputValue();
    assert.equal(now, before.replace(text, pasted), pasted);
    const line = now.slice(0, now.indexOf(pasted)).split('\n').length;
    assert.deepEqual(answer.mistakes.map((mistake) => mistake.line), [line], pasted);
    const note = page.locator(`.pe-copy .has-mistake[data-line="${line}"]`);
    assert.equal(await note.textContent(), `${now.split('\n')[line - 1]}  ◂ ${answer.mistakes[0].text}`);
    assert.equal(await page.locator('.pe-mistakes li').textContent(), `Line ${line} ${answer.mistakes[0].text}`);
    // No character makes a line of the text higher than its number.
    const [copy, numbers] = await page.evaluate(() => ['.pe-copy', '.pe-numbers'].map((name) => document.querySelector(name).scrollHeight));
    assert.ok(Math.abs(copy - numbers) < 20, `${copy} and ${numbers} high`);
    await previewAfter(page, () => page.locator('textarea').fill(before));
  }
});

check('the plot has the width of its place, also on a phone', async () => {
  const page = await open();
  for (const width of [400, 1280, 400]) {
    await page.setViewportSize({ width, height: 800 });
    await page.waitForFunction(() => {
      const place = document.querySelector('.pe-plot');
      const drawn = place.querySelector('svg').viewBox.baseVal.width;
      return drawn === Math.min(Math.max(place.clientWidth, 320), 900);
    });
    const widest = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(widest <= width, `${widest} pixels in a window of ${width}`);
  }
});

check('a valid program changes curve and summary', async () => {
  const page = await open();
  const before = await curve(page);
  const summary = await page.locator('.pe-summary').innerText();
  await caretBehind(page, 'amax_g = 70');
  const { answer } = await previewAfter(page, () => page.keyboard.press('Backspace'));
  assert.deepEqual(answer.mistakes, []);
  assert.notEqual(await curve(page), before);
  assert.notEqual(await page.locator('.pe-summary').innerText(), summary);
});

/** Puts the caret behind a text, and waits for the meaning of the key there. */
async function meaningBehind(page, text, expected) {
  await caretBehind(page, text);
  await page.waitForFunction((expected) => new RegExp(expected).test(document.querySelector('.pe-hint').textContent), expected);
}

const choices = (page) => page.locator('.pe-choices li').allInnerTexts();
const value = (page) => page.locator('textarea').inputValue();

check('the key at the caret has its sentence, unit and range', async () => {
  const page = await open();
  await meaningBehind(page, '\nspeed_hz = 60', '^speed_hz Greatest speed, .*0\\.1 to 200 rev/s$');
  await meaningBehind(page, '{ from_hz = 25', '^from_hz Lower edge');
  await meaningBehind(page, '\n[axes]', '^axes Values for all axes');
  await meaningBehind(page, '# crank radius', '^$');
  const described = await page.locator('textarea').evaluate((area) =>
    area.getAttribute('aria-describedby').split(' ').map((id) => document.getElementById(id).className));
  assert.deepEqual(described, ['pe-hint', 'pe-mistakes']);
});

check('a key is chosen by arrows and written by Tab, and can be undone', async () => {
  const page = await open();
  await meaningBehind(page, 'jerk_hz_per_s2 = 600', '^jerk');
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('.pe-choices').isVisible(), false, 'no list before a letter');
  await page.keyboard.type('stop');
  assert.deepEqual(await choices(page), ['stop_acceleration_hz_per_s', 'stop_jerk_hz_per_s2']);
  await page.keyboard.press('ArrowDown');
  const active = await page.locator('textarea').evaluate((area) => document.getElementById(area.getAttribute('aria-activedescendant')).textContent);
  assert.equal(active, 'stop_jerk_hz_per_s2');
  assert.equal(await page.locator('.pe-choices [aria-selected=true]').innerText(), 'stop_jerk_hz_per_s2');
  assert.match(await page.locator('.pe-hint').innerText(), /^stop_jerk_hz_per_s2 .*rev\/s³/);
  await page.keyboard.press('Tab');
  assert.match(await value(page), /jerk_hz_per_s2 = 600\nstop_jerk_hz_per_s2 = \n/);
  assert.equal(await page.locator('.pe-choices').isVisible(), false);
  await page.keyboard.type('900');
  await page.waitForFunction(() => document.querySelectorAll('.pe-mistakes li').length === 0);
  // Without a list, Tab leaves the text as in any form.
  await page.keyboard.press('Tab');
  assert.equal(await page.locator('textarea:focus').count(), 0);
  await page.locator('textarea').focus();
  for (let i = 0; i < 4; i++) await page.keyboard.press('Control+z');
  assert.doesNotMatch(await value(page), /stop_jerk_hz_per_s2 =/);
});

check('headings and words are listed, and the list closes without a trace', async () => {
  const page = await open();
  await meaningBehind(page, 'steps_per_turn = 3200', '^steps');
  await page.keyboard.press('Enter');
  await page.keyboard.type('[dri');
  assert.deepEqual(await choices(page), ['[drift]']);
  const before = await value(page);
  for (const close of ['Escape', 'ArrowLeft']) {
    await page.keyboard.press(close);
    await page.locator('.pe-choices').waitFor({ state: 'hidden' });
    assert.equal(await value(page), before, close);
    await caretBehind(page, '[dri');
    await page.keyboard.press('Control+Space');
    assert.deepEqual(await choices(page), ['[drift]'], 'Ctrl+Space opens it');
  }
  await page.locator('.pe-choices li').click();
  assert.match(await value(page), /3200\n\[drift\]\n/);
  await caretBehind(page, 'drive = "');
  await page.keyboard.press('Control+Space');
  assert.ok((await choices(page)).includes('"pulse-servo"'));
});

check('the list of keys stays within the text, also on a phone', async () => {
  for (const viewport of [{ width: 1280, height: 900 }, { width: 360, height: 700 }]) {
    const page = await open({ viewport });
    for (const text of ['name = "alone"', 'steps_per_turn = 3200']) {
      await meaningBehind(page, text, '^[a-z]');
      await page.keyboard.press('Enter');
      await page.keyboard.press('Control+Space');
      const [list, pane] = await page.evaluate(() => ['.pe-choices', '.pe-stack'].map((name) => document.querySelector(name).getBoundingClientRect().toJSON()));
      assert.ok(list.height >= 24, `${list.height} high`);
      assert.ok(list.left >= pane.left && list.right <= pane.right && list.top >= pane.top && list.bottom <= pane.bottom, JSON.stringify([list, pane]));
    }
  }
});

check('an example replaces the program, and can be undone', async () => {
  const page = await open();
  const before = await page.locator('textarea').inputValue();
  await page.getByLabel('Example').selectOption('Three bursts');
  const { answer } = await previewAfter(page, () => page.getByRole('button', { name: 'Replace program' }).press('Enter'));
  assert.deepEqual(answer.mistakes, []);
  const text = await page.locator('textarea').inputValue();
  assert.equal(text.match(/\[\[program\]\]/g).length, 1);
  assert.match(text, /repeat = 3/);
  await previewAfter(page, () => page.keyboard.press('Control+z'));
  assert.equal(await page.locator('textarea').inputValue(), before);
});

check('Load shows its result', async () => {
  const page = await open();
  await page.getByRole('button', { name: 'Load' }).press('Enter');
  assert.match(await page.getByRole('status').innerText(), /^\d+ characters would be loaded\.$/);
});

check('arrow keys read values from the plot', async () => {
  const page = await open();
  await page.locator('.pe-plot').focus();
  await page.keyboard.press('End');
  assert.match(await page.locator('.pe-readout').innerText(), /s, parked · requested 0 g · commanded 0 g · 0 rev\/s/);
});

check('a key has its curve soon', async () => {
  const page = await open();
  await caretBehind(page, 'hold_s = 5');
  const times = [];
  for (let key = 0; key < KEYS; key++) {
    const { answer, ms } = await previewAfter(page, () => page.keyboard.press(key % 2 ? 'Backspace' : '1'));
    assert.deepEqual(answer.mistakes, []);
    times.push(ms);
  }
  times.sort((a, b) => a - b);
  const at = (part) => times[Math.floor(part * (times.length - 1))].toFixed(0);
  const ticks = await page.evaluate(() => globalThis.previews.at(-1).answer.scene.previewed_s * 2000);
  console.log(`     from a key to its curve (${Math.round(ticks)} ticks): median ${at(0.5)} ms, 90 % within ${at(0.9)} ms, longest ${at(1)} ms`);
});

check('a program of many hours does not hold typing up', async () => {
  const page = await open();
  await caretBehind(page, 'hold_s = 3');
  await page.keyboard.type('0000');
  await page.waitForFunction(() => /Computing: \d+ %/.test(document.querySelector('.pe-summary').textContent));
  await page.evaluate(() => globalThis.longTasks.splice(0));
  await caretBehind(page, 'hold_s = 30000');
  // The page responds to keys and draws the short program, before the long one could be finished.
  const { answer } = await previewAfter(page, async () => {
    for (let i = 0; i < 4; i++) await page.keyboard.press('Backspace');
  });
  assert.deepEqual(answer.mistakes, []);
  assert.equal(answer.scene.ended.is_cut_off, false);
  assert.ok(answer.scene.previewed_s < 60, `${answer.scene.previewed_s} s are previewed`);
  const longest = await page.evaluate(() => Math.max(0, ...globalThis.longTasks));
  console.log(`     longest task of the page meanwhile: ${longest === 0 ? 'under 50' : longest.toFixed(0)} ms`);
});

check('both themes', async () => {
  const colors = [];
  for (const colorScheme of ['light', 'dark']) {
    const page = await open({ colorScheme });
    colors.push(await page.locator('.program-editor').evaluate((element) => getComputedStyle(element).backgroundColor));
    if (screenshots) await page.screenshot({ path: path.join(screenshots, `editor-${colorScheme}.png`), fullPage: true });
    if (screenshots && colorScheme === 'light') {
      await caretBehind(page, 'amax_g = 70');
      await previewAfter(page, () => page.keyboard.press('0'));
      await page.screenshot({ path: path.join(screenshots, 'editor-mistake.png'), fullPage: true });
      await page.keyboard.press('End');
      await page.keyboard.press('Enter');
      await page.keyboard.type('h');
      await page.screenshot({ path: path.join(screenshots, 'editor-keys.png'), fullPage: true });
    }
  }
  assert.notEqual(colors[0], colors[1]);
});

let failed = 0;
for (const { what, test } of checks) {
  try {
    await test();
    assert.deepEqual(problems.splice(0), [], 'no errors of the page');
    console.log(`ok   ${what}`);
  } catch (error) {
    failed += 1;
    console.log(`FAIL ${what}\n${error.message}`);
  }
}
await browser.close();
server.close();
process.exitCode = failed ? 1 : 0;
