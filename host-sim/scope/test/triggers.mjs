// Test of triggers: the window stops with the crossing at its place, to the sample.

import { check, enabled, press, state } from './harness.mjs';

export async function triggers(page) {
  await page.selectOption('#span', '1');
  if (await page.getAttribute('#pause', 'aria-pressed') === 'true') await page.click('#pause');
  await page.selectOption('#trigger-kind', 'level');
  await page.selectOption('#trigger-signal', 'speed_hz');
  await page.fill('#trigger-value', '6');
  await page.press('#trigger-value', 'Tab');
  await enabled(page, 'arm');
  await press(page, 'arm');
  await enabled(page, 'start');
  await press(page, 'start');
  await page.waitForFunction(() => globalThis.cophaseScope.parts.view.isPaused);
  const found = await page.evaluate(() => {
    const { view } = globalThis.cophaseScope.parts;
    const i = view.history.nearest(view.trigger);
    return {
      before: view.history.value('speed_hz', i - 1),
      at: view.history.value('speed_hz', i),
      place: (view.trigger - view.from) / view.span,
      complete: view.history.time(view.history.start) <= view.from && view.history.now >= view.to - 1e-3,
    };
  });
  check('a level triggers at the first sample that reaches it', found.before < 6 && found.at >= 6, `${found.before.toFixed(4)}, ${found.at.toFixed(4)} rev/s`);
  check('the crossing is at a quarter of a complete window', Math.abs(found.place - 0.25) < 1e-9 && found.complete, String(found.place));

  await page.selectOption('#trigger-kind', 'fault');
  await state(page, 'run');
  await page.selectOption('#faults [name=kind]', { label: await page.locator('#faults option', { hasText: /^drive-alarm/ }).textContent() });
  await page.click('#faults [type=submit]');
  await page.waitForFunction(() => globalThis.cophaseScope.parts.view.isPaused);
  const fault = await page.evaluate(() => {
    const { view } = globalThis.cophaseScope.parts;
    const i = view.history.nearest(view.trigger);
    const FAULT = 4;
    return [i - 1, i].map((k) => (view.history.value('flags', k) & FAULT) !== 0);
  });
  check('a fault triggers at the tick in which it latched', fault[0] === false && fault[1] === true, fault.join(', '));
  await page.click('#pause');
  await state(page, 'fault');
  await press(page, 'reset');
  await state(page, 'idle');
  await page.selectOption('#trigger-kind', 'off');
  await page.selectOption('#span', '10');
}
