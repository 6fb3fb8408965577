// Pictures of docs/scope.md.

import { join } from 'node:path';
import { ROOT, check, open, run, scope } from './harness.mjs';

export async function screenshots(chrome) {
  const server = await scope('--to', 'sim');
  try {
    const page = await open(chrome, server.url, { colorScheme: 'light' });
    await run(page);
    const passed = (seconds) => page.waitForFunction((s) => {
      const { history } = globalThis.cophaseScope.parts;
      return history.value('program_s', history.end - 1) > s;
    }, seconds);
    await passed(8);
    // A small slip on one axis, so that the drawings show a phase error.
    await page.selectOption('#faults [name=axis]', '1');
    await page.fill('#faults [name=value]', '15');
    await page.fill('#faults [name=lasts]', '0.05');
    await page.click('#faults [type=submit]');
    await passed(11.5);
    await page.click('#pause');
    await page.evaluate(() => {
      const { view } = globalThis.cophaseScope.parts;
      // The drawings show the machine at cursor A, after the slip.
      view.setCursor(0, view.from + 0.9 * view.span);
      view.setCursor(1, view.from + 0.3 * view.span);
    });
    for (const theme of ['light', 'dark']) {
      const shown = await page.evaluate(() => document.documentElement.dataset.theme);
      if (shown !== theme) await page.click('#theme');
      await page.mouse.move(1100, 780);
      await page.evaluate(() => document.activeElement.blur());
      await page.waitForTimeout(200);
      await page.screenshot({ path: join(ROOT, `docs/scope-${theme}.png`) });
      check(`docs/scope-${theme}.png is written`, true);
    }
    await page.click('#theme');
    // The top of the page stays in view, and would cover a part of the editor.
    await page.evaluate(() => { document.getElementById('top').hidden = true; });
    const editor = join(ROOT, 'docs/scope-editor.png');
    await page.locator('#editor').screenshot({ path: editor });
    check('docs/scope-editor.png is written', true);
  } finally {
    await server.stop();
  }
}
