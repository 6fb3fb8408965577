// Test of the light and the dark theme, and of the contrast of their colours.

import { check, open } from './harness.mjs';

/** Least contrast of text and of other parts, as in WCAG 2.1 AA. */
const TEXT = 4.5;
const GRAPHIC = 3;

export async function themes(chrome, url) {
  const backs = [];
  for (const scheme of ['light', 'dark']) {
    const page = await open(chrome, url, { colorScheme: scheme });
    const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
    check(`the system's ${scheme} theme is taken`, (await theme()) === scheme);
    backs.push(await page.evaluate(() => getComputedStyle(document.body).backgroundColor));
    for (const [names, min] of [
      [['--text', '--muted', '--accent', '--good', '--warn', '--bad'], TEXT],
      [['--trace-requested', '--trace-commanded', '--trace-actual', '--trace-x', '--trace-y', ...[0, 1, 2, 3, 4, 5].map((i) => `--axis-${i}`)], GRAPHIC],
    ]) {
      const low = await page.evaluate(contrasts, [names, min]);
      check(`${scheme}: contrast of ${names.length} colours is at least ${min}`, low.length === 0, low.join(', '));
    }
    await page.click('#theme');
    check('the switch takes the other theme', (await theme()) !== scheme);
    await page.reload();
    await page.waitForFunction(() => document.documentElement.dataset.theme);
    check('and a reload keeps it', (await theme()) !== scheme);
    await page.context().close();
  }
  check('the themes differ', backs[0] !== backs[1], backs.join(', '));
}

/** Returns the colours whose contrast to the panels is too low. */
function contrasts([names, min]) {
  const style = getComputedStyle(document.documentElement);
  const luminance = (name) => {
    const channels = style.getPropertyValue(name).trim().match(/[0-9a-f]{2}/gi).map((hex) => parseInt(hex, 16) / 255);
    const [r, g, b] = channels.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const panel = luminance('--panel');
  return names.flatMap((name) => {
    const [dark, bright] = [luminance(name), panel].sort((a, b) => a - b);
    const contrast = (bright + 0.05) / (dark + 0.05);
    return contrast < min ? [`${name} ${contrast.toFixed(2)}`] : [];
  });
}
