// Support for the scenarios: the server, a browser, and checks that are printed.

import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

export const HERE = dirname(fileURLToPath(import.meta.url));
export const ROOT = join(HERE, '../../..');

let failures = 0;

/** Prints a check, and counts it if it fails. */
export function check(what, isTrue, detail = '') {
  console.log(`${isTrue ? 'ok  ' : 'FAIL'} ${what}${detail === '' ? '' : `: ${detail}`}`);
  failures += isTrue ? 0 : 1;
}

export const failed = () => failures;

/** Starts a program, and resolves with the first line that matches. Other lines go to the standard error. */
export function start(program, args, pattern, options = {}) {
  const child = spawn(program, args, { stdio: ['pipe', 'pipe', 'inherit'], ...options });
  const ready = new Promise((resolve, reject) => {
    createInterface({ input: child.stdout }).on('line', (line) => {
      const found = line.match(pattern);
      if (found) resolve(found);
      else console.error(`  ${line}`);
    });
    child.on('error', reject);
    child.on('exit', (code) => reject(new Error(`${program} ended with status ${code}`)));
  });
  const stop = () => new Promise((resolve) => {
    if (child.exitCode !== null || child.signalCode !== null) return resolve();
    child.once('exit', () => resolve());
    child.kill('SIGCONT');
    child.kill('SIGTERM');
    return undefined;
  });
  return { ready, stop, signal: (name) => child.kill(name) };
}

/** Starts `cophase scope` on a line, and returns the address of its page. `signal` sends the process a signal. */
export async function scope(...args) {
  const program = process.env.COPHASE ?? join(ROOT, 'target/debug/cophase');
  if (!existsSync(program)) {
    throw new Error(`${program}: not there; run \`cargo build -p cophase\`, or set COPHASE to the command`);
  }
  const server = start(program, ['scope', ...args], /^(http:\/\/\S+)$/);
  const [, url] = await server.ready;
  return { ...server, url };
}

/** Starts headless chromium. */
export async function browser() {
  const paths = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  const executablePath = paths.find((path) => path && existsSync(path));
  if (!executablePath) {
    throw new Error('chromium: not there; install it (Debian: apt-get install chromium), or set CHROMIUM to its path');
  }
  return chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-gpu'] });
}

/**
 * Opens the page of the scope, and waits for its controller. Errors of the page are failures, except for connections to the server
 * that a test ends. `prepare` is called before the page is loaded.
 */
export async function open(chrome, url, options = {}, prepare = () => {}) {
  const context = await chrome.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  page.on('pageerror', (error) => check('no error of the page', false, error.message));
  page.on('console', (line) => {
    const isRefused = /^WebSocket connection to .* failed/.test(line.text());
    if (line.type() === 'error' && !isRefused) check('no error in the console', false, line.text());
  });
  await prepare(page);
  await page.goto(url);
  await page.waitForFunction(() => globalThis.cophaseScope?.parts?.history.end > 0);
  return page;
}

/** Writes a picture to target/scope-pages, for a look at it. */
export async function picture(page, name) {
  await page.screenshot({ path: join(ROOT, `target/scope-pages/${name}.png`) });
}

/** Takes control, arms and starts. */
export async function run(page) {
  await press(page, 'control');
  await enabled(page, 'arm');
  await press(page, 'arm');
  await enabled(page, 'start');
  await press(page, 'start');
  await state(page, 'run');
}

/** Waits for a state of the machine. */
export const state = (page, name) => page.waitForFunction(
  (name) => document.getElementById('state').dataset.state === name, name, { timeout: 120_000 });

/** Returns the points of a plot that are drawn now: [times, ...columns]. */
export const drawn = (page, id) => page.evaluate((id) => {
  const names = [...document.querySelectorAll('.plot')].map((plot) => plot.dataset.plot);
  return globalThis.cophaseScope.parts.plots[names.indexOf(id)].data;
}, id);

export const press = (page, action) => page.click(`[data-action=${action}]`);

/** Waits until a control is possible. */
export const enabled = (page, action) => page.waitForSelector(`[data-action=${action}][aria-disabled=false]`);
