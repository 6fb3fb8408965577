// Test of the page's layout: from a phone to a desktop, with a stop that is always in view.

import { check, open, picture, press, run, state } from './harness.mjs';

const DESK = { width: 1280, height: 800 };
const PHONE = { width: 400, height: 800 };
const TURNED = { width: 800, height: 400 };

/** Least height of the stop, and of any other control, CSS pixels (WCAG 2.2: 2.5.5 and 2.5.8). */
const STOP_PX = 44;
const TARGET_PX = 24;

export async function sizes(chrome, url) {
  const page = await open(chrome, url);
  await run(page);
  await everythingIsOpen(page);
  for (const size of [DESK, PHONE, TURNED, { width: 320, height: 640 }, { width: 601, height: 800 }, { width: 901, height: 700 }]) {
    const name = `${size.width} × ${size.height}`;
    await page.setViewportSize(size);
    await plotsFit(page, name);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    check(`${name}: nothing is wider than the window`, width <= size.width, `${width} pixels`);
    await stopIsInView(page, name);
  }
  await page.setViewportSize(PHONE);
  const small = await page.evaluate((min) => [...document.querySelectorAll('button, select, input, textarea')]
    .filter((e) => e.checkVisibility() && e.getBoundingClientRect().height < min).map((e) => e.outerHTML), TARGET_PX);
  check('every control is large enough for a finger', small.length === 0, small.join(' '));
  // There and back again: the plots become narrower as well as wider.
  for (const [i, size] of [DESK, PHONE, DESK, TURNED, PHONE].entries()) {
    await page.setViewportSize(size);
    await plotsFit(page, `resize ${i + 1}, to ${size.width} × ${size.height}`);
  }
  await page.evaluate(() => scrollTo(0, 0));
  await press(page, 'stop-now');
  await state(page, 'parked');
  check('the stop acts on a phone, beside an open list of keys', await page.isVisible('#help'));
  await page.click('#help button');
  for (const [name, size] of [['desk', DESK], ['phone', PHONE], ['turned', TURNED]]) {
    await page.setViewportSize(size);
    await page.evaluate(() => scrollTo(0, 0));
    await picture(page, name);
    await page.evaluate(() => document.getElementById('editor').scrollIntoView());
    await picture(page, `${name}-editor`);
  }
  await press(page, 'control');
  await page.context().close();
}

/** Opens all panels and dialogs that can be open at the same time. */
async function everythingIsOpen(page) {
  await page.selectOption('#trigger-kind', 'level');
  await page.evaluate(() => {
    const { view } = globalThis.cophaseScope.parts;
    view.pause();
    view.setCursor(0, view.to - 0.1);
    view.setCursor(1, view.to);
  });
  await page.click('#help-button');
  await page.waitForSelector('#cursors:not([hidden])');
  await picture(page, 'all-open');
}

async function plotsFit(page, name) {
  const fits = page.waitForFunction((width) => {
    const fit = [...document.querySelectorAll('.plot .canvas')].every((place) => {
      const canvas = place.querySelector('canvas');
      return canvas.clientWidth === place.clientWidth && canvas.clientHeight === place.clientHeight;
    });
    const live = document.getElementById('plots').clientWidth;
    return fit && live > width / 2 && live < width;
  }, page.viewportSize().width);
  check(`${name}: the plots fill their places`, await fits.then(() => true, () => false));
}

async function stopIsInView(page, name) {
  const places = { top: 0, middle: 0.5, end: 1 };
  const hidden = [];
  for (const [place, part] of Object.entries(places)) {
    const found = await page.evaluate((part) => {
      scrollTo(0, part * document.documentElement.scrollHeight);
      const stop = document.getElementById('stop-now');
      const { left, top, width, height, right, bottom } = stop.getBoundingClientRect();
      const isInView = left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
      return { height, isInView, isOnTop: document.elementFromPoint(left + width / 2, top + height / 2) === stop };
    }, part);
    if (!(found.isInView && found.isOnTop && found.height >= STOP_PX)) hidden.push(place, JSON.stringify(found));
  }
  check(`${name}: the stop is in view wherever the page is, and above the open list of keys`, hidden.length === 0, hidden.join(' '));
}
