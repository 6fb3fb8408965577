// Test of the page with the emulated board, which runs the real firmware behind a TCP port.

import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { ROOT, check, drawn, enabled, open, press, scope, start, state } from './harness.mjs';

/** The board runs at about a quarter of real time. */
const PATIENCE = { timeout: 300_000 };

export async function board(chrome) {
  const elf = join(ROOT, 'target/thumbv6m-none-eabi/firmware/cophase-firmware');
  if (!existsSync(elf)) {
    throw new Error(`${elf}: not there; run \`cargo build --locked --profile firmware --target thumbv6m-none-eabi -p cophase-firmware\``);
  }
  const bridge = start('node', [join(ROOT, 'tests/emulator/bridge.mjs'), '--transport', 'usb'], /^port (\d+)$/);
  try {
    const [, port] = await bridge.ready;
    const server = await scope('--to', `tcp:127.0.0.1:${port}`);
    try {
      await operate(await open(chrome, server.url));
    } finally {
      await server.stop();
    }
  } finally {
    await bridge.stop();
  }
}

/** Samples that the server lost before the page had its first one. */
const lostBefore = () => {
  const [, lost] = /^lost (\d+)/.exec(document.getElementById('losses').textContent);
  return lost - globalThis.cophaseScope.parts.history.missing;
};

async function operate(page) {
  check('the board is no simulated machine, and takes no faults', await page.isHidden('#faults'));
  await press(page, 'control');
  await enabled(page, 'arm');
  const before = await page.evaluate(lostBefore);
  const text = await page.inputValue('#editor textarea');
  await page.locator('#editor textarea').fill(text.replace('amax_g = 15', 'amax_g = 9').replace('ramp_s = 4', 'ramp_s = 0.5'));
  await page.click('#editor button:text-matches("^Load")');
  await page.waitForFunction(() => /Loaded/.test(document.getElementById('editor').textContent), undefined, PATIENCE);
  check('an edited program is loaded to the board', true);
  await press(page, 'arm');
  await enabled(page, 'start');
  await press(page, 'start');
  await state(page, 'run');
  await page.waitForFunction(() => {
    const { history } = globalThis.cophaseScope.parts;
    return history.value('amax_commanded_mps2', history.end - 1) > 8.9 * 9.80665;
  }, undefined, PATIENCE);
  const [, , commanded] = await drawn(page, 'amplitude');
  const last = commanded.filter((value) => value !== null).at(-1);
  check('the plots show the edited amplitude of 9 g', Math.abs(last - 9) < 0.15, `${last.toFixed(3)} g`);
  const steps = await page.evaluate(() => {
    const { history } = globalThis.cophaseScope.parts;
    return [0, 1, 2, 3].map((axis) => history.value(`steps_${axis}`, history.end - 1));
  });
  check('all axes step alike', steps.every((count) => Math.abs(count) === Math.abs(steps[0])) && steps[0] !== 0, steps.join(', '));
  await page.keyboard.press('Space');
  await state(page, 'parked');
  check('Space stops the board', true);
  // Status and samples are separate messages, so one of them may be ahead.
  const agree = await page.waitForFunction((before) => {
    const [, lost] = /^lost (\d+) · dropped \d+$/.exec(document.getElementById('losses').textContent);
    return lost - globalThis.cophaseScope.parts.history.missing === before ? `lost ${lost}` : false;
  }, before, PATIENCE);
  check('samples that are missing are those that are shown as lost', true, await agree.jsonValue());
}
