// Test of the page without a mouse.

import { check, enabled, state } from './harness.mjs';

export async function keyboard(page) {
  await page.evaluate(() => document.activeElement.blur());
  await everyControlHasAVisibleFocus(page);
  await page.evaluate(() => document.activeElement.blur());

  await enabled(page, 'arm');
  await page.keyboard.press('a');
  await enabled(page, 'start');
  await page.keyboard.press('g');
  await state(page, 'run');
  check('the keys a and g arm and start', true);
  await page.keyboard.press('h');
  await page.waitForFunction(() => /held/.test(document.getElementById('state').textContent));
  await page.keyboard.press('r');
  await page.waitForFunction(() => !/held/.test(document.getElementById('state').textContent));
  check('the keys h and r hold and resume', true);

  // Space stops the machine, and does not press the button that has the focus.
  await page.focus('#theme');
  const theme = await page.evaluate(() => document.documentElement.dataset.theme);
  await page.keyboard.press('Space');
  await state(page, 'parked');
  const same = (await page.evaluate(() => document.documentElement.dataset.theme)) === theme;
  check('Space stops now, whatever has the focus', same);

  await page.keyboard.press('p');
  await page.keyboard.press('1');
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('2');
  for (let i = 0; i < 5; i++) await page.keyboard.press('Shift+ArrowRight');
  const rows = await page.locator('#cursors tbody tr').first().locator('td').allTextContents();
  const [a, b, difference] = rows.map((text) => Number(text.replace('−', '-')));
  check('keys place both cursors, and their difference is shown', a > 0 && Math.abs(b - a - difference) < 2e-4 && rows[3] === 's',
    rows.join(' '));
  await page.keyboard.press('0');
  check('a key clears the cursors', await page.isHidden('#cursors'));
  const span = await page.inputValue('#span');
  await page.keyboard.press('+');
  check('a key zooms in', Number(await page.inputValue('#span')) < Number(span));
  await page.keyboard.press('-');
  await page.keyboard.press('p');
  await page.keyboard.press('?');
  check('a key shows the keys', await page.isVisible('#help'));
  await page.keyboard.press('Escape');

  // In a text, keys are characters.
  await page.focus('#editor textarea');
  await page.keyboard.press('Control+End');
  await page.keyboard.type(' # gap');
  check('keys write in the editor', (await page.inputValue('#editor textarea')).endsWith(' # gap'));
}

async function everyControlHasAVisibleFocus(page) {
  const expected = await page.evaluate(() =>
    [...document.querySelectorAll('button, select, input, textarea')].filter((e) => e.checkVisibility()).length);
  const reached = new Set();
  let plain = 0;
  for (let i = 0; i < expected + 20; i++) {
    await page.keyboard.press('Tab');
    const focus = await page.evaluate(() => {
      const e = document.activeElement;
      if (!e.matches('button, select, input, textarea')) return undefined;
      e.dataset.number ??= String(Math.random());
      return { number: e.dataset.number, outline: getComputedStyle(e).outlineStyle };
    });
    if (!focus) continue;
    if (reached.has(focus.number)) break;
    reached.add(focus.number);
    plain += focus.outline === 'none' ? 1 : 0;
  }
  check('Tab reaches every control, with a visible focus', reached.size === expected && plain === 0,
    `${reached.size} of ${expected}, ${plain} without`);
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, select, input, textarea, svg, canvas#timeline')]
    .filter((e) => !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.[0]?.textContent.trim())).map((e) => e.outerHTML));
  check('every control and drawing has a name', nameless.length === 0, nameless.join(' '));
}
