// Test of a page that loses contact with the controller: the server ends or hangs, the network drops, or the server loses its line.

import { join } from 'node:path';
import { HERE, ROOT, check, open, picture, press, run, scope, start, state } from './harness.mjs';

const SCENE = join(HERE, 'scene.toml');

export async function contact(chrome) {
  await serverHangsAndEnds(chrome);
  await networkDrops(chrome);
  await lineIsLost(chrome);
}

const lost = (page, what) => page.waitForFunction((what) => {
  const banner = document.getElementById('lost');
  return !banner.hidden && banner.textContent.startsWith(what);
}, what);

const restored = (page) => page.waitForFunction(() => document.getElementById('lost').hidden);

/** Checks that nothing on the page looks as if it were known or possible. */
async function nothingIsKnown(page, name, { passesStop }) {
  const shown = await page.evaluate(() => ({
    state: document.getElementById('state').textContent,
    flags: document.getElementById('flags').textContent,
    hint: document.getElementById('hint').textContent,
    alerts: [...document.querySelectorAll('.alert')].filter((e) => e.checkVisibility()).map((e) => e.id),
    banner: document.getElementById('lost').textContent,
    possible: [...document.querySelectorAll('[data-action]')].filter((e) => e.ariaDisabled !== 'true').map((e) => e.dataset.action),
    pressed: [...document.querySelectorAll('[data-action][aria-pressed=true]')].map((e) => e.dataset.action),
    load: document.querySelector('#editor [data-part=load]').disabled,
    bright: ['main', '#editor', '#info', '#state'].filter((e) => getComputedStyle(document.querySelector(e)).opacity > 0.6),
  }));
  check(`${name}: the state is unknown`, shown.state === 'unknown' && shown.flags === '' && shown.hint === '', `${shown.state} ${shown.flags}`);
  check(`${name}: one banner names the loss, its time, and where to stop the machine`,
    shown.alerts.join() === 'lost' && / since \d\d:\d\d:\d\d/.test(shown.banner) && /may be moving/.test(shown.banner)
      && /STOP input or the emergency stop at the machine/.test(shown.banner), shown.banner);
  const possible = passesStop ? ['stop-now', 'stop'] : [];
  check(`${name}: no control is possible${passesStop ? ', except the stops' : ''}`,
    shown.possible.join() === possible.join() && shown.pressed.length === 0 && shown.load, shown.possible.join());
  check(`${name}: the page is dim`, shown.bright.length === 0, shown.bright.join());
}

async function pictures(page, name) {
  await picture(page, name);
  await page.setViewportSize({ width: 400, height: 800 });
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  check(`${name}: 400 pixels are wide enough`, width <= 400, String(width));
  await picture(page, `${name}-phone`);
  await page.setViewportSize({ width: 1280, height: 800 });
}

async function serverHangsAndEnds(chrome) {
  const server = await scope('--to', `sim:${SCENE}`);
  try {
    const page = await open(chrome, server.url);
    await run(page);
    server.signal('SIGSTOP');
    await lost(page, 'No status of the controller');
    await nothingIsKnown(page, 'a server that hangs', { passesStop: true });
    await pictures(page, 'no-status');
    server.signal('SIGCONT');
    await restored(page);
    await state(page, 'run');
    check('the state is shown again with the next status', (await page.textContent('#flags')).includes('drives on'));
    // A stop that was pressed meanwhile is carried out.
    server.signal('SIGSTOP');
    await lost(page, 'No status of the controller');
    await press(page, 'stop-now');
    const text = await page.textContent('#message');
    check('a stop without contact refers to the stop of the machine', /emergency stop at the machine/.test(text), text);
    server.signal('SIGCONT');
    await state(page, 'parked');
    check('and acts if it arrives', true);
    server.signal('SIGKILL');
    await lost(page, 'No connection to the server');
    await nothingIsKnown(page, 'a server that ended', { passesStop: false });
    await pictures(page, 'no-server');
    await page.keyboard.press('Space');
    const refused = await page.textContent('#message');
    check('a stop that cannot be sent refers to the stop of the machine', /cannot reach the controller.*emergency stop/.test(refused), refused);
    await page.context().close();
  } finally {
    await server.stop();
  }
}

async function networkDrops(chrome) {
  const server = await scope('--to', `sim:${SCENE}`);
  try {
    const sockets = [];
    const page = await open(chrome, server.url, {}, (page) => page.routeWebSocket(/\/socket$/, (socket) => {
      socket.connectToServer();
      sockets.push(socket);
    }));
    await run(page);
    const events = await page.locator('#event-list li').count();
    await sockets[0].close();
    await lost(page, 'No connection to the server');
    await restored(page);
    await state(page, 'run');
    const kept = await page.locator('#event-list li').count();
    check('a page connects again by itself, and keeps its events', sockets.length === 2 && kept === events, `${kept} of ${events} events`);
    await page.context().close();
  } finally {
    await server.stop();
  }
}

async function lineIsLost(chrome) {
  const controller = join(ROOT, 'target/debug/examples/controller');
  const first = start(controller, [SCENE], /^port (\d+)$/);
  const [, port] = await first.ready;
  const server = await scope('--to', `tcp:127.0.0.1:${port}`);
  let second;
  try {
    const page = await open(chrome, server.url);
    await run(page);
    await first.stop();
    await lost(page, 'No line to the controller');
    await nothingIsKnown(page, 'a lost line', { passesStop: false });
    await pictures(page, 'no-line');
    second = start(controller, [SCENE, port], /^port (\d+)$/);
    await second.ready;
    await restored(page);
    await state(page, 'idle');
    check('the page shows a controller that is there again', await page.textContent('#connection') === 'connected');
    second.signal('SIGSTOP');
    await lost(page, 'No status of the controller');
    await nothingIsKnown(page, 'a controller that hangs', { passesStop: true });
    second.signal('SIGCONT');
    await restored(page);
    await page.context().close();
  } finally {
    await server.stop();
    await first.stop();
    await second?.stop();
  }
}
