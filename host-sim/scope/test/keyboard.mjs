// Test of the page without a mouse.

import { check, enabled, press, state } from './harness.mjs';

/** Keys that act on a control, or did so once. */
const CONTROL_KEYS = ['Enter', 'ArrowUp', 'ArrowRight', 'PageDown', 'Home', ...'acghjorsx'];

export async function keyboard(page) {
  await page.evaluate(() => document.activeElement.blur());
  await everyControlHasAVisibleFocus(page);
  await page.evaluate(() => {
    // A key sends its request at once.
    globalThis.requests = [];
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function record(data) {
      globalThis.requests.push(JSON.parse(data).request);
      return send.call(this, data);
    };
  });
  await noSingleKeyMovesTheMachine(page);
  await aStopKeyActsEverywhere(page);
  await ctrlEnterPressesControls(page);
  await viewKeys(page);
}

/** Times that a jog is tried, and the longest wait for its third request, ms. */
const JOG_TRIES = 5;
const JOG_WAIT_MS = 5000;

/** Returns the requests that an action sends. */
async function requests(page, action) {
  await page.evaluate(() => globalThis.requests.splice(0));
  await action();
  return page.evaluate(() => globalThis.requests.join());
}

const blur = (page) => page.evaluate(() => document.activeElement.blur());

/** Presses a key, and holds it: the browser repeats it twice. */
async function hold(page, key) {
  for (let i = 0; i < 3; i++) await page.keyboard.down(key);
  await page.keyboard.up(key);
}

async function noSingleKeyMovesTheMachine(page) {
  await enabled(page, 'arm');
  await press(page, 'arm');
  await enabled(page, 'start');
  const sent = await requests(page, async () => {
    await blur(page);
    for (const key of 'abcdefghijklmnopqrsuvwxyz') await page.keyboard.press(key);
    await page.keyboard.press('p');
    await page.keyboard.press('?');
    for (const key of CONTROL_KEYS) await page.keyboard.press(key);
    await page.keyboard.press('Escape');
    const places = page.locator('[data-action]:not(.stop), #faults input');
    for (const place of await places.all()) {
      await place.focus();
      for (const key of CONTROL_KEYS) await page.keyboard.press(key);
    }
  });
  check('no single key acts on a machine that is armed, whatever has the focus or is open', sent === '', sent);
  check('the machine is still idle', await page.textContent('#state') === 'idle');
  check('the reason is shown', /Ctrl\+Enter/.test(await page.textContent('#message')), await page.textContent('#message'));
}

async function aStopKeyActsEverywhere(page) {
  const theme = await page.evaluate(() => document.documentElement.dataset.theme);
  for (const place of ['#theme', '[data-action=start]', '#trigger-kind', '#faults [name=value]', '#event-list']) {
    await page.focus(place);
    check(`Space stops, with the focus on ${place}`, await requests(page, () => page.keyboard.press('Space')) === 'stop');
  }
  const same = (await page.evaluate(() => document.documentElement.dataset.theme)) === theme;
  check('Space does not press the button that has the focus', same);
  await page.focus('#editor textarea');
  await page.keyboard.press('Control+End');
  const typed = await requests(page, () => page.keyboard.type(' # gap'));
  check('keys write in the editor', (await page.inputValue('#editor textarea')).endsWith(' # gap') && typed === '', typed);
  check('Escape stops, with the focus in the editor', await requests(page, () => page.keyboard.press('Escape')) === 'stop');
  await page.keyboard.press('Control+Home');
  await page.keyboard.type('des');
  check('a key that is typed has a list', await page.isVisible('#editor .pe-choices'));
  check('Escape stops beside the list, and closes it', await requests(page, () => page.keyboard.press('Escape')) === 'stop'
    && await page.isHidden('#editor .pe-choices'));
  await blur(page);
  check('a stop key that is held stops once', await requests(page, () => hold(page, ' ')) === 'stop');
  await page.keyboard.press('?');
  check('a key shows the keys', await page.isVisible('#help'));
  check('Space stops beside the open list of keys', await requests(page, () => page.keyboard.press('Space')) === 'stop');
  const before = await page.getAttribute('#pause', 'aria-pressed');
  const other = await requests(page, () => page.keyboard.press('p'));
  check('no other key acts then', other === '' && await page.getAttribute('#pause', 'aria-pressed') === before);
  check('Escape closes the list, and does not stop', await requests(page, () => page.keyboard.press('Escape')) === '' && await page.isHidden('#help'));
}

async function ctrlEnterPressesControls(page) {
  const ctrl = (key) => async () => {
    await page.keyboard.down('Control');
    await hold(page, key);
    await page.keyboard.up('Control');
  };
  await enabled(page, 'arm');
  await page.focus('[data-action=arm]');
  const sent = await requests(page, ctrl('Enter'));
  check('Ctrl+Enter that is held presses a control once', /^(dis)?arm$/.test(sent), sent);
  if (sent === 'disarm') {
    await page.waitForSelector('[data-action=arm][aria-pressed=false]');
    await page.keyboard.press('Control+Enter');
  }
  await enabled(page, 'start');
  await page.focus('[data-action=start]');
  await page.keyboard.press('Control+Enter');
  await state(page, 'run');
  check('Ctrl+Enter arms and starts', true);
  await page.focus('[data-action=override]');
  check('Ctrl and an arrow move the slider by a step', await requests(page, ctrl('ArrowRight')) === 'override'
    && await page.inputValue('[data-action=override]') === '101');
  await page.keyboard.press('Control+ArrowLeft');
  await enabled(page, 'hold');
  await page.focus('[data-action=hold]');
  await page.keyboard.press('Control+Enter');
  await page.waitForFunction(() => /held/.test(document.getElementById('state').textContent));
  await page.focus('[data-action=resume]');
  await page.keyboard.press('Control+Enter');
  await page.waitForFunction(() => !/held/.test(document.getElementById('state').textContent));
  check('Ctrl+Enter holds and resumes', true);
  await page.focus('[data-action=stop-now]');
  check('Enter alone stops, once', await requests(page, () => hold(page, 'Enter')) === 'stop');
  await state(page, 'parked');
  await enabled(page, 'arm');
  // A jog ends by itself when a request comes late, as on a busy computer: then it begins again.
  let jogs = '';
  for (let tries = 0; tries < JOG_TRIES && !jogs.includes('jog,jog,jog'); tries += 1) {
    await state(page, 'parked');
    await enabled(page, 'arm');
    if (await page.getAttribute('[data-action=arm]', 'aria-pressed') !== 'true') await press(page, 'arm');
    await enabled(page, 'jog');
    await page.focus('[data-action=jog]');
    jogs = await requests(page, async () => {
      await page.keyboard.down('Control');
      await page.keyboard.down('Enter');
      await page.waitForFunction(() => globalThis.requests.length > 2, undefined, { timeout: JOG_WAIT_MS }).catch(() => {});
      await page.keyboard.up('Enter');
      await page.keyboard.up('Control');
    });
  }
  check('a jog lasts while Ctrl+Enter is held', /^jog(,jog)+$/.test(jogs), jogs);
  await state(page, 'parked');
  check('and then ends', await requests(page, () => state(page, 'parked')) === '');
}

async function viewKeys(page) {
  await blur(page);
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
