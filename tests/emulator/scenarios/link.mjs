// Host link: a program sent over USB or UART runs as `cophase run` predicts, streams are complete or report their
// gaps, a load is quick and survives power cuts, and a busy line does not affect the loop.

import { PROGRAM, SETTINGS, requests } from '../bench/frames.mjs';
import * as goals from '../bench/goals.mjs';
import { predict, scene, settingsOf, withAxes } from '../bench/host.mjs';
import { LinkHost } from '../bench/link-host.mjs';
import { log } from '../bench/log.mjs';
import { Machine, flashWith } from '../bench/machine.mjs';
import { watchMasked } from '../bench/masked.mjs';
import { namesAt } from '../bench/profile.mjs';
import { act } from '../bench/play.mjs';
import { run as play, summary } from '../bench/ticks.mjs';
import { FLASH_ID } from '../board/chip.mjs';
import { TIMER_IRQ_1 } from '../board/usage.mjs';
import { edgesOff } from './parity.mjs';

/** Channels of a stream: all of firmware/link/src/sample.rs. */
const ALL_CHANNELS = (1 << 11) - 1;

/** Loads: a program of this many segments, in at most these times, s. */
const SEGMENTS = 64;
const LOAD_S = { usb: 1, uart: 2 };

/** The shortest flash operations, for tests where only their order matters. */
const QUICK = { flashTimes: { eraseSector: 2000, programPage: 500 } };

export const title = 'Link: programs, streams, loads and power cuts over USB and UART';

export function run(outcome) {
  programs(outcome);
  closing(outcome);
  loads(outcome);
  cuts(outcome);
  saturation(outcome);
}

// ---- a program that is sent over the link ----

/** The same scene with another program: one level, one second. */
function otherProgram(toml) {
  toml.program = [{ amax_g: 1, ramp_s: 0.5, hold_s: 0.5 }];
}

function programs(outcome) {
  for (const [transport, name, axes] of [['usb', 'gears', undefined], ['usb', 'everything', 6], ['uart', 'everything', 4]]) {
    const change = axes === undefined ? () => {} : withAxes(axes);
    const played = scene(name, change);
    const source = new Machine({ ...played, settings: settingsOf(played) });
    source.boot();
    const first = new LinkHost(source, transport);
    first.connect();
    const serial = Buffer.from(FLASH_ID).readBigUInt64BE();
    outcome.check(first.serial() === serial, `${transport}: the serial number is that of the flash chip, ${serial.toString(16)}`);
    const program = first.readFile(PROGRAM);

    const other = scene(name, (toml) => { change(toml); otherProgram(toml); });
    const machine = new Machine({ ...played, settings: settingsOf(other) });
    machine.boot();
    const host = new LinkHost(machine, transport);
    host.connect();
    host.ask(requests.takeControl());
    host.writeFile(PROGRAM, program);
    host.ask(requests.stream(ALL_CHANNELS, Math.max(1, Math.floor(played.tickHz / 1000))));
    host.ask(requests.arm());
    host.send(requests.start());
    const began = machine.begins();
    const predicted = predict(played);
    act(machine, played, predicted, began);
    const { edges, off } = edgesOff(machine, played, predicted, began);
    outcome.check(off === null, `${transport}, ${name}: every edge is where \`cophase run\` has it: ${off}`);
    const { received, gaps, lost } = streamed(host);
    outcome.check(received > 100, `${transport}, ${name}: samples come`);
    outcome.check(gaps <= lost, `${transport}, ${name}: every lost sample is counted, not ${lost} of ${gaps}`);
    if (transport === 'usb') outcome.check(lost === 0, `${transport}, ${name}: no sample is lost, not ${lost}`);
    const hz = played.tickHz / host.samples[0].every;
    outcome.say(`${transport}, ${name}, ${played.axes} axes: ${edges} edges, 0 cycles off; at ${hz} Hz ${received} samples, ${lost} lost, all counted`);
  }
}

/** Samples received, those missing between them, and those that the controller counted as lost. */
function streamed(host) {
  const runs = host.samples;
  const received = runs.reduce((sum, { count }) => sum + count, 0);
  let gaps = 0;
  runs.slice(1).forEach(({ tick, every }, i) => {
    gaps += (tick - runs[i].tick) / every - runs[i].count;
  });
  return { received, gaps, lost: host.samplesLost() };
}

// ---- a port that is closed ----

/** Refusals, as firmware/link/src/message.rs numbers them. */
const NO_CONTROL = 3;

/** Control and streams end with the port; the machine runs on. */
function closing(outcome) {
  const played = scene('hold');
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const host = new LinkHost(machine, 'usb');
  host.connect();
  host.ask(requests.takeControl());
  host.ask(requests.stream(ALL_CHANNELS, 1));
  host.ask(requests.arm());
  host.ask(requests.start());
  machine.run(0.05);
  host.link.close();
  machine.run(0.05);
  outcome.check(machine.level('enable') === 1, 'the machine runs on when the port is closed');
  host.link.open();
  machine.run(0.01);
  const before = host.bytes;
  machine.run(0.1);
  outcome.check(host.bytes === before, `streams end with the port, not ${host.bytes - before} bytes later`);
  outcome.check(host.refusal(requests.beginWrite(PROGRAM, Buffer.alloc(1))) === NO_CONTROL, 'control ends with the port');
  outcome.say('a closed USB port ends control and streams, and the machine runs on');
}

// ---- how long a load takes ----

/** A program of many segments. */
function manySegments(toml) {
  toml.program = Array.from({ length: SEGMENTS }, (_, i) => ({ amax_g: 0.5 + (i % 7) / 10, ramp_s: 0.5, hold_s: 0.25 + i / 100 }));
}

function loads(outcome) {
  const made = scene('start-stop', (toml) => { withAxes(2)(toml); manySegments(toml); });
  const source = new Machine({ ...made, settings: settingsOf(made) });
  source.boot();
  const reader = new LinkHost(source, 'usb');
  reader.connect();
  const program = reader.readFile(PROGRAM);
  for (const transport of ['usb', 'uart']) {
    const played = scene('start-stop', withAxes(2));
    const machine = new Machine({ ...played, settings: settingsOf(played) });
    machine.boot();
    const host = new LinkHost(machine, transport);
    host.connect();
    const from = host.seconds;
    host.ask(requests.takeControl());
    host.writeFile(PROGRAM, program);
    const took = host.seconds - from;
    outcome.check(host.readFile(PROGRAM).equals(program), `${transport}: the program is read back as it was written`);
    outcome.check(took < LOAD_S[transport], `${transport}: ${SEGMENTS} segments load in ${LOAD_S[transport]} s, not ${took.toFixed(3)} s`);
    outcome.figure(`program of ${SEGMENTS} segments over ${transport}, ms`, Math.round(1000 * took));
    outcome.say(`${transport}: ${SEGMENTS} segments (${program.length} bytes) in ${(1000 * took).toFixed(0)} ms`);
  }
}

// ---- power cuts ----

const CUT_AFTER = [0, 1, 97, 255, 2048, 4095];

function cuts(outcome) {
  const older = settingsOf(scene('hold'));
  const newer = settingsOf(scene('start-stop'));
  let count = 0;
  for (let operation = 0; ; operation += 1) {
    const torn = CUT_AFTER.map((bytes) => cut(outcome, older, newer, { operation, bytes }));
    count += torn.filter(Boolean).length;
    if (!torn.some(Boolean)) break;
  }
  outcome.check(count > 20, `at least 20 power cuts are tried, not ${count}`);
  outcome.say(`${count} power cuts while settings are loaded: each next start ran, on whole settings`);
}

/** Loads settings, and cuts the power in one operation of the flash. Gives whether the cut occurred. */
function cut(outcome, older, newer, where) {
  const flash = flashWith(older);
  const machine = new Machine({ axes: 4, tickHz: 2000, flash, options: QUICK });
  machine.boot();
  const host = new LinkHost(machine, 'uart');
  host.connect();
  host.ask(requests.takeControl());
  machine.board.rom.cutPower(where);
  let isCut = false;
  try {
    host.writeFile(SETTINGS, newer);
  } catch (error) {
    isCut = /power-cut/.test(error.message);
    if (!isCut) throw error;
  }
  const again = new Machine({ axes: 4, tickHz: 2000, flash, options: QUICK });
  again.boot();
  again.run(0.01);
  const runs = log(again.board).find((line) => /settings: /.test(line)) ?? '';
  const expected = isCut ? /settings: (hold|start-stop), / : /settings: start-stop, /;
  outcome.check(expected.test(runs), `cut in operation ${where.operation} after ${where.bytes} bytes: the next start runs whole settings: ${runs}`);
  return isCut;
}

// ---- a busy line ----

/** Interrupts of the timers, of USB, of UART1 and of the sampler (16 + their numbers in the datasheet). */
const BESIDE_THE_LOOP = [16, 16 + 5, 16 + 21, 16 + 26];

const SATURATED_EVERY_NS = 250_000;
const BUSY_BYTES = 4096;

function saturation(outcome) {
  // Without faults: the link shifts the readings by cycles, and a correction of a slip would begin at another time with it.
  const played = scene('everything', withAxes(6));
  const [predicted, settings] = [predict(played), settingsOf(played)];
  const quiet = summary(play(played, predicted, settings).ticks);
  let host;
  let masked;
  let isBusy = true;
  const prepare = (machine) => {
    host = new LinkHost(machine, 'usb');
    host.connect();
    host.ask(requests.stream(ALL_CHANNELS, 1));
    host.ask(requests.streamStatus(10));
    const block = Buffer.alloc(384, 0xa5);
    const refill = () => {
      if (!isBusy) return;
      while (host.link.pending < BUSY_BYTES) host.send(requests.write(0, block));
      machine.board.clock.later(SATURATED_EVERY_NS, refill);
    };
    refill();
    masked = watchMasked(machine.board);
  };
  const { ticks, machine } = play(played, predicted, settings, { prepare });
  const busy = summary(ticks);
  isBusy = false;
  const seconds = ticks.length / played.tickHz;
  const perSecond = (bytes) => Math.round(bytes / seconds / 1000);
  outcome.say(`6 axes, worst tick ${quiet.worst} cycles without a host, ${busy.worst} with USB saturated both ways (mean ${quiet.mean.toFixed(0)}, ${busy.mean.toFixed(0)})`);
  outcome.say(`latest beginning of a tick: ${quiet.late} cycles after the first one's without a host, ${busy.late} with it`);
  const [blocker] = namesAt([masked.setter]).get(masked.setter);
  outcome.say(`interrupts are blocked for ${masked.longest} cycles at most, by ${blocker}: no tick begins later than that`);
  outcome.figure('interrupts blocked with the link saturated, cycles at most', masked.longest);
  const { received, lost } = streamed(host);
  outcome.say(`${perSecond(host.bytes)} kB/s to the host meanwhile: ${received} samples of ${(host.sampleBytes / received).toFixed(1)} bytes, ${lost} lost`);
  for (const number of BESIDE_THE_LOOP) {
    const [own, loop] = [number, TIMER_IRQ_1].map((exception) => machine.board.core.exceptionPriority(exception));
    outcome.check(own > loop, `exception ${number} has a lower priority than the loop, not ${own} and ${loop}`);
  }
  outcome.goal('tick of 6 axes, worst, with the link saturated, more cycles', busy.worst - quiet.worst, goals.LINK_TICK_CYCLES);
}
