// Test of the limits and forbidden bands in the live plots.

import { check } from './harness.mjs';

/** Returns the number of dashed lines in a plot: rows of pixels, a large part of which has the colour of limits. */
const lines = (id) => {
  const canvas = document.querySelector(`[data-plot=${id}] canvas`);
  const { data, width, height } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  const warn = getComputedStyle(document.documentElement).getPropertyValue('--warn').match(/[0-9a-f]{2}/gi).map((hex) => parseInt(hex, 16));
  let count = 0;
  for (let y = 0; y < height; y++) {
    let same = 0;
    for (let x = 0; x < width; x++) same += warn.every((value, i) => data[4 * (y * width + x) + i] === value);
    count += same > 0.3 * width;
  }
  return count;
};

/** Checks that a plot has a number of dashed lines, as soon as the page has drawn its newest samples: a busy computer draws late. */
async function shows(page, what, id, expected) {
  const isDrawn = `(${lines})('${id}') === ${expected}`;
  await page.waitForFunction(isDrawn, null, { timeout: 10_000 }).catch(() => {});
  const count = await page.evaluate(lines, id);
  check(what, count === expected, String(count));
}

/** The speed is near the forbidden band and the limit of the scene; the amplitude is near the band. */
export async function limitsOfSpeed(page) {
  await shows(page, 'the plot of the speed shows the limit and both edges of the band', 'speed', 3);
  await shows(page, 'the plot of the amplitude shows both edges of the band', 'amplitude', 2);
  await shows(page, 'a limit of the tilt far beyond the values is no line', 'tilt', 0);
  const names = await page.locator('.plot').evaluateAll((plots) => plots.map((plot) => plot.getAttribute('aria-label')));
  check('the names of the plots have their limits', /limit 20 rev\/s; band 9 to 10 rev\/s$/.test(names[1]) && /limit ±1 mrad$/.test(names[3]),
    names.join(', '));
}

/** The tilt is near its limit after a slip. */
export async function limitOfTilt(page) {
  await shows(page, 'the plot of the tilt shows its limit at both sides', 'tilt', 2);
}
