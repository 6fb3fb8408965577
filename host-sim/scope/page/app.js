// The page: makes all parts, and passes them the messages of the server.

import { Circle, Level } from './circle.js';
import { Contact } from './contact.js';
import { Controls, STOP_THERE, reasonAgainst } from './controls.js';
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
  closed: () => contact.lose('server'),
});
const controls = new Controls(document.body, socket, message);
const contact = new Contact(showContact);

const REPORTS = {
  hello: (hello) => {
    if (parts === undefined) begin(hello);
    else parts.hello = hello;
  },
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
  // The next status shows that the line is there again.
  line: ({ error }) => error !== null && contact.lose('line', error),
};

/** Shows that contact is lost, or that it is there again. */
function showContact(loss) {
  document.body.classList.toggle('lost', loss !== undefined);
  const banner = find('lost');
  banner.hidden = loss === undefined;
  find('connection').className = loss === undefined ? 'good' : 'bad';
  if (loss === undefined) {
    const { hello } = parts;
    find('machine').textContent = `${hello.settings} · ${hello.axes} axes · ${hello.tick_hz} ticks/s · ${hello.board}`;
    find('connection').title = `This page is ${hello.name}.`;
    find('connection').textContent = hello.simulated ? 'simulated' : 'connected';
    return;
  }
  find('connection').textContent = 'no contact';
  showKnown({ status: undefined, passesStop: loss.passesStop });
  const { what, since, problem, remedy } = loss;
  const lines = [
    `${what} since ${since.toLocaleTimeString([], { hour12: false })}${problem === undefined ? '' : `: ${problem}`}.`,
    `The machine may be moving. ${STOP_THERE}`,
    remedy,
  ];
  banner.replaceChildren(...lines.map((text, i) => {
    const line = document.createElement(i === 1 ? 'strong' : 'span');
    line.textContent = text;
    return line;
  }));
}

function begin(hello) {
  const { axes } = hello;
  const history = new History(hello.columns, hello.tick_hz);
  const view = new View(history);
  const trigger = new Trigger(history, view);
  const configs = plots(axes, hello.limits);
  parts = {
    hello,
    history,
    view,
    trigger,
    plots: configs.map((config, i) => new Plot(find('plots'), config, view, i === configs.length - 1)),
    timeline: new Timeline(find('timeline'), find('event-list'), view, hello.states),
    circle: new Circle(find('circle'), find('needle-scale'), axes),
    level: hello.limits.tilt_mrad === null ? undefined : new Level(find('level'), find('tilt-value'), hello.limits.tilt_mrad),
    cursors: new Cursors(find('cursors'), view, configs),
    toolbar: new Toolbar(document, view, trigger, configs),
    editor: createEditor(find('editor'), { text: hello.text, onLoad: load }),
  };
  find('level').closest('figure').hidden = parts.level === undefined; // A machine without a platform tilts nothing.
  if (hello.simulated) {
    find('faults').hidden = false;
    wireFaults(find('faults'), axes, (fault) => controls.act('inject', { fault }));
  }
  view.onChange(() => parts.cursors.update());
  wireTheme(find('theme'), () => redrawn((plot) => plot.build()));
  const resized = new ResizeObserver(() => redrawn((plot) => plot.resize()));
  for (const canvas of [...parts.plots.map((plot) => plot.canvas), find('timeline')]) resized.observe(canvas);
  wireSaving();
  const keys = viewKeys();
  wireKeys(() => controls.act('stop-now'), keys, find('help'));
  listKeys(find('help').querySelector('tbody'), [...STOP_KEYS, ...keys]);
  // Nothing is modal: the stop can always be pressed.
  find('help-button').addEventListener('click', () => find('help').show());
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
  contact.status();
  showKnown({ status, passesStop: true });
}

/** Shows the status; without contact, there is none. */
function showKnown(known) {
  const { status } = known;
  controls.update(known);
  const badge = find('state');
  badge.dataset.state = status?.state ?? 'unknown';
  badge.textContent = status?.holding ? `${status.state}, held` : badge.dataset.state;
  parts?.editor.refuse(reasonAgainst('load', known));
  // The reason why the machine cannot start, while it is at rest.
  const missing = ['idle', 'parked'].includes(status?.state) ? reasonAgainst('start', known) : undefined;
  find('hint').textContent = missing === undefined ? '' : `To start: ${missing}.`;
  find('flags').textContent = status === undefined ? '' : notes(status).filter(Boolean).join(' · ');
  showFault(status);
  if (status === undefined) return;
  const { lost_samples: lost, dropped_samples: dropped, dropped_reports: reports } = status;
  find('losses').textContent = `lost ${lost} · dropped ${dropped + reports}`;
  find('losses').className = lost + dropped + reports > 0 ? 'bad' : '';
}

function notes(status) {
  return [
    status.armed && 'armed',
    status.drives ? 'drives on' : 'drives off',
    !status.enable && 'enable open',
    status.stop_input && 'stop input',
    status.control === 'other' && `${status.owner ?? 'another host'} has control`,
    status.browsers > 1 && `${status.browsers} pages`,
  ];
}

function showFault(status) {
  const fault = find('fault');
  const name = status?.fault ?? null;
  fault.hidden = name === null;
  const holds = status?.drives && status.state === 'fault';
  const next = holds ? 'the drives hold; a reset switches them off' : 'reset it to go on';
  const text = name === null ? '' : `${name} — ${next}`;
  // An alert is read aloud when its text changes.
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

/** The keys that stop the machine, as the help lists them. */
const STOP_KEYS = [
  { key: ' ', text: 'stop now, whatever has the focus' },
  { key: 'Esc', text: 'in the text of the editor: stop now; else: close this list' },
];

function viewKeys() {
  const { view, toolbar } = parts;
  return [
    { key: 'p', text: 'pause or go on', down: () => toolbar.togglePause() },
    { key: '+', text: 'zoom in', repeats: true, down: () => view.zoom(-1) },
    { key: '-', text: 'zoom out', repeats: true, down: () => view.zoom(1) },
    { key: 'ArrowLeft', text: 'earlier; with Shift, cursor A by a sample', repeats: true, down: (event) => move(event, -1) },
    { key: 'ArrowRight', text: 'later; with Shift, cursor A by a sample', repeats: true, down: (event) => move(event, 1) },
    { key: '1', text: 'cursor A in the middle', down: () => view.setCursor(0, (view.from + view.to) / 2) },
    { key: '2', text: 'cursor B in the middle', down: () => view.setCursor(1, (view.from + view.to) / 2) },
    { key: '0', text: 'clear the cursors', down: () => toolbar.clearCursors() },
    { key: 't', text: 'switch the theme', down: () => find('theme').click() },
    { key: '?', text: 'show this list', down: () => find('help').show() },
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
