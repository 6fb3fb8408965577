// The page: makes all parts, and passes them the messages of the server.

import { Circle, Level } from './circle.js';
import { Controls, REASONS } from './controls.js';
import { Cursors } from './cursors.js';
import { createEditor } from './editor.js';
import { wireFaults } from './faults.js';
import { History } from './history.js';
import { listKeys, wireKeys } from './keys.js';
import { Plot } from './plots.js';
import { csv, download, vcd } from './save.js';
import { plots } from './signals.js';
import { Socket } from './socket.js';
import { wireTheme } from './theme.js';
import { Timeline } from './timeline.js';
import { Toolbar } from './toolbar.js';
import { Trigger } from './trigger.js';
import { View } from './view.js';

const find = (id) => document.getElementById(id);

/** All parts, once the server has sent the data of the machine. */
let parts;

const message = (text, isError) => {
  find('message').textContent = text;
  find('message').className = isError ? 'error' : '';
};

const socket = new Socket({
  report: (report) => REPORTS[report.type]?.(report),
  batch: (batch) => parts?.history.add(batch),
  closed: () => {
    find('connection').textContent = 'server gone';
    find('connection').className = 'bad';
    document.body.classList.add('offline');
  },
});
const controls = new Controls(document.body, socket, message);

const REPORTS = {
  hello: begin,
  status: showStatus,
  event: (event) => {
    parts.timeline.add(event);
    parts.drawn = undefined;
    parts.trigger.event(event);
  },
  restarted: () => {
    parts.history.clear();
    parts.timeline.clear();
    parts.view.resume();
  },
  line: ({ error }) => {
    find('connection').textContent = error === null ? 'connected' : 'line lost';
    find('connection').className = error === null ? 'good' : 'bad';
    message(error ?? 'the controller is there again', error !== null);
  },
};

function begin(hello) {
  const { axes } = hello;
  const history = new History(hello.columns, hello.tick_hz);
  const view = new View(history);
  const trigger = new Trigger(history, view);
  const configs = plots(axes);
  parts = {
    hello,
    history,
    view,
    trigger,
    plots: configs.map((config, i) => new Plot(find('plots'), config, view, i === configs.length - 1)),
    timeline: new Timeline(find('timeline'), find('event-list'), view, hello.states),
    circle: new Circle(find('circle'), find('needle-scale'), axes),
    level: hello.limits.tilt_mrad === null ? undefined : new Level(find('level'), find('tilt-value'), hello.limits.tilt_mrad),
    cursors: new Cursors(find('cursors'), view, axes),
    toolbar: new Toolbar(document, view, trigger, configs),
  };
  find('level').closest('figure').hidden = parts.level === undefined; // A machine without a platform tilts nothing.
  find('connection').title = `This page is ${hello.name}.`;
  find('machine').textContent = `${hello.settings} · ${axes} axes · ${hello.tick_hz} ticks/s · ${hello.board}`;
  find('connection').textContent = hello.simulated ? 'simulated' : 'connected';
  find('connection').className = 'good';
  if (hello.simulated) {
    find('faults').hidden = false;
    wireFaults(find('faults'), axes, (fault) => controls.act('inject', { fault }));
  }
  createEditor(find('editor'), { text: hello.text, onLoad: load });
  view.onChange(() => parts.cursors.update());
  wireTheme(find('theme'), () => redrawn((plot) => plot.build()));
  new ResizeObserver(() => redrawn((plot) => plot.resize())).observe(find('plots'));
  wireSaving();
  const keys = keyTable();
  wireKeys(keys);
  listKeys(find('help').querySelector('tbody'), keys);
  find('help-button').addEventListener('click', () => find('help').showModal());
  requestAnimationFrame(draw);
}

/** Changes all plots, and draws them again even if the window is stopped. */
function redrawn(change) {
  parts.plots.forEach(change);
  parts.drawn = undefined;
}

/** Loads a program. Returns the sentence to show, or throws an error with the reason. */
async function load(text) {
  await socket.request('load', { text });
  return 'Loaded. It runs until the controller restarts.';
}

function showStatus(status) {
  controls.update(status);
  const badge = find('state');
  badge.textContent = status.holding ? `${status.state}, held` : status.state;
  badge.dataset.state = status.state;
  // The reason why the machine cannot start, while it is at rest.
  const missing = ['idle', 'parked'].includes(status.state) ? REASONS.start(status) : undefined;
  find('hint').textContent = missing === undefined ? '' : `To start: ${missing}.`;
  const notes = [
    status.armed && 'armed',
    status.drives ? 'drives on' : 'drives off',
    !status.enable && 'enable open',
    status.stop_input && 'stop input',
    status.control === 'other' && `${status.owner ?? 'another host'} has control`,
    status.browsers > 1 && `${status.browsers} pages`,
  ];
  find('flags').textContent = notes.filter(Boolean).join(' · ');
  const { lost_samples: lost, dropped_samples: dropped, dropped_reports: reports } = status;
  find('losses').textContent = `lost ${lost} · dropped ${dropped + reports}`;
  find('losses').className = lost + dropped + reports > 0 ? 'bad' : '';
  const fault = find('fault');
  fault.hidden = status.fault === null;
  // An alert is read aloud when its text changes.
  const holds = status.drives && status.state === 'fault';
  const next = holds ? 'the drives hold; a reset switches them off' : 'reset it to go on';
  const text = status.fault === null ? '' : `${status.fault} — ${next}`;
  if (fault.textContent !== text) {
    fault.textContent = text;
  }
}

function wireSaving() {
  const save = (make, name, type) => () => {
    const { history, from, to } = parts.view;
    download(name, make(history, from, to, parts.hello.states), type);
  };
  find('save-csv').addEventListener('click', save(csv, 'scope.csv', 'text/csv'));
  find('save-vcd').addEventListener('click', save(vcd, 'scope.vcd', 'text/plain'));
}

function keyTable() {
  const { view, toolbar } = parts;
  return [
    { key: ' ', text: 'stop now', down: () => controls.act('stop-now') },
    { key: 's', text: 'stop at the parking phase', down: () => controls.act('stop') },
    { key: 'c', text: 'take or release control', down: () => controls.act('control') },
    { key: 'a', text: 'arm or disarm', down: () => controls.act('arm') },
    { key: 'g', text: 'start (go)', down: () => controls.act('start') },
    { key: 'h', text: 'hold', down: () => controls.act('hold') },
    { key: 'r', text: 'resume', down: () => controls.act('resume') },
    { key: 'o', text: 'home', down: () => controls.act('home') },
    { key: 'j', text: 'jog while it is held', down: () => controls.beginJog(), up: () => controls.endJog() },
    { key: 'x', text: 'reset a fault', down: () => controls.act('reset') },
    { key: 'p', text: 'pause or go on', down: () => toolbar.togglePause() },
    { key: '+', text: 'zoom in', repeats: true, down: () => view.zoom(-1) },
    { key: '-', text: 'zoom out', repeats: true, down: () => view.zoom(1) },
    { key: 'ArrowLeft', text: 'earlier; with Shift, cursor A by a sample', repeats: true, down: (event) => move(event, -1) },
    { key: 'ArrowRight', text: 'later; with Shift, cursor A by a sample', repeats: true, down: (event) => move(event, 1) },
    { key: '1', text: 'cursor A in the middle', down: () => view.setCursor(0, (view.from + view.to) / 2) },
    { key: '2', text: 'cursor B in the middle', down: () => view.setCursor(1, (view.from + view.to) / 2) },
    { key: '0', text: 'clear the cursors', down: () => toolbar.clearCursors() },
    { key: 't', text: 'switch the theme', down: () => find('theme').click() },
    { key: '?', text: 'show this list', down: () => find('help').showModal() },
  ];
}

function move(event, direction) {
  if (event.shiftKey) {
    parts.view.stepCursor(0, direction);
  } else {
    parts.view.pan(direction * 0.1);
  }
}

function draw() {
  const { history, view, trigger, circle, level, timeline } = parts;
  trigger.update();
  if (!view.isPaused || parts.drawn !== view.version) {
    parts.drawn = view.version;
    parts.plots.forEach((plot) => plot.draw());
    timeline.draw();
  }
  const shown = view.history;
  if (!shown.isEmpty) {
    // A stopped window shows the cranks at cursor A, if there is one.
    const at = view.isPaused ? shown.nearest(view.cursors[0] ?? view.to) : history.end - 1;
    const value = (name) => shown.value(name, at);
    circle.draw(Array.from({ length: parts.hello.axes }, (_, i) => value(`phase_error_deg_${i}`)), value('phase_turns'));
    level?.draw(value('tilt_x_mrad'), value('tilt_y_mrad'));
  }
  parts.toolbar.draw();
  requestAnimationFrame(draw);
}

// Tests compare the drawn values with the saved ones.
globalThis.cophaseScope = { get parts() { return parts; } };
