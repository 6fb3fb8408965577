// Stops by the host: a stop acts in time at every accepted tick rate, whatever streams.
//
// Each scene is drawn over all keys that cost the loop time (search/draw.mjs), and runs at the highest tick rate that the board accepts for
// it, so that the link has the least time. All channels are streamed at every tick, and statuses as often as possible. At some moment of the
// run the host sends a stop. The time is from there to the deadline at which the loop enters the state `stop`, as the log has it.

import { Cranks } from '../bench/cranks.mjs';
import { requests } from '../bench/frames.mjs';
import { scene } from '../bench/host.mjs';
import { LinkHost } from '../bench/link-host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import { inverted } from '../bench/pins.mjs';
import { accepted, atMost, countOr, SEED } from '../search/accepted.mjs';
import { draw, random } from '../search/draw.mjs';

const MAX_S = 0.02;

/** Scenes of each line, besides the fixed ones. */
const COUNT = countOr(3);

/** Channels of a stream: all of firmware/link/src/sample.rs. The shortest period of statuses, ms. */
const ALL_CHANNELS = (1 << 11) - 1;
const STATUS_MS = 10;

/** The UART takes the pins of the fifth axis: properties of a genome from 0 up to here have four axes at most. */
const UART_AXES_BELOW = 0.375;

/** Homing, proof of the wiring included, and the time of the run in which the stop comes. */
const MAX_HOMING_S = 3;
const RUN_S = 0.3;
const MIN_S = 0.05;

/** Scenes that are drawn for one that runs. */
const MAX_TRIES = 8;

export const title = 'Stops: a stop by the host acts within 20 ms, whatever streams';

export function run(outcome) {
  for (const transport of ['usb', 'uart']) {
    const next = random(SEED + (transport === 'usb' ? 0 : 1));
    const all = [...fixed(transport, next), ...Array.from({ length: COUNT }, () => stopped(transport, next))];
    const times = all.map(({ seconds }) => seconds);
    for (const { toml, seconds, share, kind, reason } of all) {
      outcome.say(
        `${transport}, ${toml.axes.count} axes at ${toml.control.tick_hz} ticks a second: ${kind === 1 ? 'stop now' : 'stop'} after ${ms(seconds)} ms; ` +
          `${(100 * share).toFixed(0)} % of the samples`,
      );
      outcome.check(seconds <= MAX_S, `${transport}: a stop acts within ${1000 * MAX_S} ms, not ${ms(seconds)}${reason === undefined ? '' : `: ${reason}`}`);
    }
    const inTime = times.filter((seconds) => seconds <= MAX_S).length;
    const shares = all.map(({ share }) => share).sort((a, b) => a - b);
    outcome.say(
      `${transport}: ${inTime} of ${all.length} stops in time, at most ${ms(Math.max(...times))} ms; of the samples ${percent(shares[0])} to ` +
        `${percent(shares.at(-1))} arrived, ${percent(shares[shares.length >> 1])} in the median`,
    );
    outcome.figure(`stop by the host over ${transport}, all channels streamed, ms at most`, 1000 * Math.max(...times), 'neither');
  }
}

const ms = (seconds) => (seconds * 1000).toFixed(1);
const percent = (share) => `${(100 * share).toFixed(0)} %`;

/** The scenes of the longest ticks, over USB: they have too many axes for the UART. */
function fixed(transport, next) {
  if (transport !== 'usb') return [];
  return ['longest-tick', 'missed-deadline'].map((name) => {
    const { toml } = scene(name);
    held(toml);
    return stop(toml, atMost(toml).settings, transport, next);
  });
}

/** Draws scenes until one runs, and stops it. Gives { toml, seconds: until the stop acted, share: of the samples, kind: of the stop }. */
function stopped(transport, next) {
  const reasons = [];
  for (let tries = 0; tries < MAX_TRIES; tries += 1) {
    const { drawn, settings } = accepted(() => {
      const genome = draw(next);
      return transport === 'usb' ? genome : { ...genome, axes: genome.axes * UART_AXES_BELOW };
    }, held);
    const result = stop(drawn.toml, settings, transport, next);
    if (result.seconds !== undefined) return result;
    // The machine may not suit the scene. What the board did wrong must not be drawn again.
    if (/overrun|missed|underrun|watchdog/.test(result.reason)) return { toml: drawn.toml, seconds: Infinity, share: 0, kind: 0, reason: result.reason };
    reasons.push(result.reason);
  }
  throw new Error(`of ${MAX_TRIES} scenes none runs:\n${reasons.join('\n')}`);
}

/** A program that lasts: nothing but the host stops the machine. */
function held(toml) {
  toml.program = [{ ...toml.program[0], ramp_s: 0.2, hold_s: 60 }];
}

function stop(toml, settings, transport, next) {
  const tickHz = toml.control.tick_hz;
  const machine = new Machine({ axes: toml.axes.count, tickHz, settings, inverted: inverted(toml.wiring) });
  machine.boot();
  const host = new LinkHost(machine, transport);
  host.connect();
  host.ask(requests.takeControl());
  host.ask(requests.stream(ALL_CHANNELS, 1));
  host.ask(requests.streamStatus(STATUS_MS));
  host.ask(requests.arm());
  const number = host.number;
  host.send(requests.start());
  const began = machine.begins();
  host.until(() => host.reply?.number === number, 1, 'the start has no reply');
  new Cranks(machine.board, toml); // replaces the record of edges
  const entered = (states) => log(machine.board).map((line) => line.match(/tick (\d+): (\w+), phase/)).filter((match) => match && states.includes(match[2]));
  for (let seconds = 0; entered(['Run', 'Fault']).length === 0; seconds += 0.05) {
    if (seconds > MAX_HOMING_S) return { reason: 'homing takes longer' };
    machine.run(0.05);
  }
  machine.run(RUN_S * next());
  if (entered(['Fault']).length > 0) return { reason: log(machine.board).find((line) => /fault:/.test(line)) };
  const before = received(host);
  const from = machine.board.cycle;
  machine.run(MIN_S + RUN_S * next());
  const share = (received(host) - before) / ((machine.board.cycle - from) / machine.tick);
  const kind = Math.floor(2 * next());
  const sent = machine.board.cycle;
  host.send(requests.stop(kind));
  machine.run(2 * MAX_S);
  machine.run(0.05); // for the log
  const [[, first]] = entered(['Homing', 'Run']);
  const [, last] = entered(['Stop']).at(-1) ?? [];
  if (last === undefined) return { toml, seconds: Infinity, share, kind };
  return { toml, seconds: (began + (Number(last) - Number(first)) * machine.tick - sent) / CYCLES_PER_S, share, kind };
}

const received = (host) => host.samples.reduce((sum, { count }) => sum + count, 0);
