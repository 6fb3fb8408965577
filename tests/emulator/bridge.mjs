// The emulated board as a serial port: README.md, "A board behind a port".

import fs from 'node:fs';
import readline from 'node:readline';
import { parseArgs } from 'node:util';
import { Cranks } from './bench/cranks.mjs';
import { scene, settingsOf } from './bench/host.mjs';
import { TRANSPORTS, linkTo } from './bench/link.mjs';
import { CYCLES_PER_S, Machine } from './bench/machine.mjs';
import { Operator } from './bench/operator.mjs';
import { COPHASE, FIRMWARE } from './bench/paths.mjs';
import { Server } from './bench/serve.mjs';

/** The scene whose settings are built into the firmware. */
const BUILT_IN_SCENE = 'default';
/** Time on the board's clock in which its firmware attaches to USB, and the host configures it. */
const MAX_S = 5;

const HELP = `usage: node bridge.mjs [--elf FILE] [--transport usb|uart] [--uart 0|1] [--baud RATE] [--port PORT] [--scene SCENE] [--fast]

Runs the firmware in the emulator and puts its host link behind a TCP port on loopback, for one client at a time.
Prints "port N" once the link is there. Its cranks follow the steps, and their index sensors answer.

  --elf FILE        the firmware; default: the one built by \`cargo firmware\`
  --transport KIND  usb (default) or uart
  --uart NUMBER     which UART, 1 by default
  --baud RATE       baud rate of this end; default: that of the board
  --port PORT       TCP port; default 0: any that is free
  --scene SCENE     name or file of a scene, whose settings are placed in the flash; default: those built in
  --fast            as fast as it goes, instead of at most in real time

Commands, one a line on the standard input, each answered by "ok" or "error": unplug, plug, reset-bus, suspend, resume,
power-cut, power-up, press start, enable on, enable off, place cranks. The end of the input ends it, as SIGTERM does.

Exit status: 0 ended so; 1 the board stopped or did not attach; 2 bad arguments.`;

const say = (line) => process.stdout.write(`${line}\n`);

function bad(text) {
  console.error(`bridge: ${text}\n\n${HELP}`);
  process.exit(2);
}

function options() {
  const string = (fallback) => ({ type: 'string', default: fallback });
  const flag = { type: 'boolean', default: false };
  try {
    const { values } = parseArgs({
      options: {
        elf: string(FIRMWARE),
        transport: string('usb'),
        uart: string('1'),
        baud: { type: 'string' },
        port: string('0'),
        scene: { type: 'string' },
        fast: flag,
        help: { ...flag, short: 'h' },
      },
    });
    return values;
  } catch (error) {
    return bad(error.message);
  }
}

const given = options();
if (given.help) {
  say(HELP);
  process.exit(0);
}
const number = (name, min, max) => {
  const value = Number(given[name]);
  if (!Number.isInteger(value) || value < min || value > max) bad(`--${name} is ${given[name]}: give a whole number from ${min} to ${max}`);
  return value;
};
if (!TRANSPORTS.includes(given.transport)) bad(`--transport is ${given.transport}: give one of ${TRANSPORTS.join(', ')}`);
if (!fs.existsSync(given.elf)) bad(`--elf is ${given.elf}, which does not exist: build the firmware with \`cargo firmware\`, or give its file`);
const uart = number('uart', 0, 1);
const port = number('port', 0, 65535);
const baud = given.baud === undefined ? null : number('baud', 300, 4_000_000);

let played;
let settings;
try {
  played = scene(given.scene ?? BUILT_IN_SCENE);
  if (given.scene !== undefined) settings = settingsOf(played);
} catch (error) {
  if (error.syscall === 'open') bad(`--scene is ${given.scene}, which does not exist: give a file, or a name in tests/emulator/scenes or host-sim/scenes`);
  if (!fs.existsSync(COPHASE)) bad(`--scene needs ${COPHASE}, which does not exist: build it with \`cargo build --release --package cophase\``);
  bad(`--scene is ${given.scene}: ${error.message}`);
}

const machine = new Machine({ ...played, settings, options: { elf: fs.readFileSync(given.elf), pins: {}, watched: [] } });
const { board } = machine;
const cranks = new Cranks(board, played.toml);
const link = linkTo(board, { transport: given.transport, uart, baud });
link.onError = (text) => say(`event error: ${text}`);

const server = new Server(board, link, {
  fast: given.fast,
  report: say,
  ended: (problem) => {
    if (problem) console.error(`bridge: ${problem.message}`);
    say(`ended after ${server.seconds.toFixed(3)} s of the board`);
    process.exit(problem ? 1 : 0);
  },
});
board.run({ cycles: MAX_S * CYCLES_PER_S, until: () => link.ready });
if (!link.ready) server.close(new Error(`the firmware did not come up as a serial port over USB within ${MAX_S} s of the board`));

const operator = new Operator(machine, cranks, link, given.transport);
const lines = readline.createInterface({ input: process.stdin });
lines.on('line', (line) => {
  if (line.trim() === '') return;
  try {
    operator.obey(line);
    say(`ok ${line.trim()}`);
  } catch (error) {
    say(`error: ${error.message}`);
  }
});
lines.on('close', () => server.close());
process.on('SIGTERM', () => server.close());
process.on('SIGINT', () => server.close());
server.listen(port).then(
  (actual) => {
    say(`port ${actual}`);
    server.run();
  },
  (error) => server.close(new Error(`cannot listen on port ${port}: ${error.message}`)),
);
