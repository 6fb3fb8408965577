// Test of the limits and forbidden bands in the live plots.

import { check } from './harness.mjs';

/** Returns the number of dashed lines in a plot: rows of pixels, a large part of which has the colour of limits. */
const lines = (page, id) => page.evaluate((id) => {
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
}, id);

/** The speed is near the forbidden band and the limit of the scene; the amplitude is near the band. */
export async function limitsOfSpeed(page) {
  check('the plot of the speed shows the limit and both edges of the band', await lines(page, 'speed') === 3, String(await lines(page, 'speed')));
  check('the plot of the amplitude shows both edges of the band', await lines(page, 'amplitude') === 2, String(await lines(page, 'amplitude')));
  check('a limit of the tilt far beyond the values is no line', await lines(page, 'tilt') === 0, String(await lines(page, 'tilt')));
  const names = await page.locator('.plot').evaluateAll((plots) => plots.map((plot) => plot.getAttribute('aria-label')));
  check('the names of the plots have their limits', /limit 20 rev\/s; band 9 to 10 rev\/s$/.test(names[1]) && /limit ±3 mrad$/.test(names[3]),
    names.join(', '));
}

/** The tilt is near its limit after a slip. */
export async function limitOfTilt(page) {
  check('the plot of the tilt shows its limit at both sides', await lines(page, 'tilt') === 2, String(await lines(page, 'tilt')));
}
