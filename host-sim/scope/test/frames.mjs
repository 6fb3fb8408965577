// Frames a second, long tasks, and processor time a frame, with six axes at 2 kHz.

import { join } from 'node:path';
import { HERE, check, open, run, scope } from './harness.mjs';

const MEASURED_MS = 10_000;

export async function frames(chrome) {
  const server = await scope('--to', `sim:${join(HERE, 'scene.toml')}`);
  try {
    const page = await open(chrome, server.url);
    await run(page);
    // Processor time of the page's thread, s. It does not contain other processes.
    const session = await page.context().newCDPSession(page);
    await session.send('Performance.enable', { timeDomain: 'threadTicks' });
    const cpu = async () => {
      const { metrics } = await session.send('Performance.getMetrics');
      return metrics.find(({ name }) => name === 'TaskDuration').value;
    };
    for (const [span, filled] of [[1, 1], [10, 10], [60, 60]]) {
      await page.waitForFunction((s) => globalThis.cophaseScope.parts.history.now > s, filled, { timeout: 120_000 });
      await page.selectOption('#span', String(span));
      const begin = await cpu();
      const found = await page.evaluate(measure, MEASURED_MS);
      const used = (await cpu()) - begin;
      console.log(
        `window ${span} s: ${found.frames.toFixed(1)} frames/s, ${found.long} long tasks, longest gap ${found.gap.toFixed(0)} ms, ` +
        `${(1000 * used / (found.frames * MEASURED_MS / 1000)).toFixed(1)} ms of processor time a frame`,
      );
    }
    check('no sample is lost or dropped', /^lost 0 · dropped 0$/.test(await page.textContent('#losses')));
  } finally {
    await server.stop();
  }
}

/** Counts frames and tasks of more than 50 ms. */
function measure(duration) {
  return new Promise((resolve) => {
    let long = 0;
    const observer = new PerformanceObserver((list) => { long += list.getEntries().length; });
    observer.observe({ type: 'longtask' });
    let [frames, gap, last, start] = [0, 0, undefined, undefined];
    const count = (time) => {
      start ??= time;
      if (last !== undefined) {
        frames += 1;
        gap = Math.max(gap, time - last);
      }
      last = time;
      if (time - start < duration) {
        requestAnimationFrame(count);
        return;
      }
      observer.disconnect();
      resolve({ frames: (1000 * frames) / (last - start), long, gap });
    };
    requestAnimationFrame(count);
  });
}
