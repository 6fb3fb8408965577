// The commands of docs/first-machine.md, one after the other, run by the real command on the emulated
// board.

import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import readline from 'node:readline';
import test from 'node:test';
import { FLASH_SIZE, loadInto, readElf } from '../board/elf.mjs';
import { COPHASE, FIRMWARE, INSPECT, ROOT } from '../bench/paths.mjs';

const PAGE = path.join(ROOT, 'docs/first-machine.md');
const BRIDGE = path.join(ROOT, 'tests/emulator/bridge.mjs');

const missing = [COPHASE, FIRMWARE, INSPECT].find((file) => !fs.existsSync(file));
const skip = missing ? `${missing} is not built: run tests/emulator/run first` : false;

/** The operator's manual actions before a command, as commands of the bridge. */
const BY_HAND = {
  'cophase link restart': ['enable off'],
  'cophase link home --yes --wait': ['place cranks', 'enable on'],
};

/** Lines of the page's code blocks, in order. */
const commands = fs
  .readFileSync(PAGE, 'utf8')
  .split('\n')
  .filter((line) => /^ +cophase /.test(line))
  .map((line) => line.trim());

/** The bridge, with its lines on standard output. */
class Bridge {
  constructor() {
    this.child = spawn(process.execPath, [BRIDGE, '--fast'], { stdio: ['pipe', 'pipe', 'inherit'] });
    this.waiting = [];
    this.lines = [];
    readline.createInterface({ input: this.child.stdout }).on('line', (line) => {
      this.lines.push(line);
      this.waiting.splice(0).forEach((wake) => wake());
    });
    this.child.on('exit', () => this.waiting.splice(0).forEach((wake) => wake()));
  }

  /** Waits for a line that begins with this text, and gives it. */
  async line(beginning) {
    for (;;) {
      const at = this.lines.findIndex((line) => line.startsWith(beginning));
      if (at >= 0) return this.lines.splice(0, at + 1).pop();
      if (this.child.exitCode !== null) throw new Error(`the bridge ended before it printed ${beginning}`);
      await new Promise((resolve) => this.waiting.push(resolve));
    }
  }

  async obey(command) {
    this.child.stdin.write(`${command}\n`);
    await this.line(`ok ${command}`);
  }

  async end() {
    this.child.stdin.end();
    if (this.child.exitCode === null) await new Promise((resolve) => this.child.on('exit', resolve));
  }
}

/** Runs a command of the page in a folder; commands of the link go to a line. */
function run(command, folder, to) {
  const [words, file] = command.split(' > ');
  const [, ...args] = words.split(' ');
  if (args[0] === 'link') args.push('--to', to);
  return new Promise((resolve) => {
    const child = spawn(COPHASE, args, { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
    const out = [];
    child.stdout.on('data', (bytes) => out.push(bytes));
    child.stderr.on('data', (bytes) => out.push(bytes));
    child.on('exit', (status) => {
      const text = Buffer.concat(out).toString();
      if (file) fs.writeFileSync(path.join(folder, file), text);
      resolve({ status, text });
    });
  });
}

test('every command of docs/first-machine.md does what the page says', { skip }, async (t) => {
  assert.ok(fs.readFileSync(PAGE, 'utf8').split('\n').length <= 40, 'the page is short');
  assert.ok(commands.length >= 14, `commands are found, not ${commands.length}`);
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'cophase-first-'));
  const bridge = new Bridge();
  const to = `tcp:127.0.0.1:${(await bridge.line('port ')).slice(5)}`;
  try {
    for (const command of commands) {
      for (const hand of BY_HAND[command] ?? []) await bridge.obey(hand);
      const { status, text } = await run(command, folder, to);
      t.diagnostic(`${command}: ${text.trim().split('\n').pop()}`);
      assert.equal(status, 0, `${command}:\n${text}`);
      CHECKS.find(([pattern]) => pattern.test(command))?.[1](text);
    }
  } finally {
    await bridge.end();
    fs.rmSync(folder, { recursive: true });
  }
});

const has = (pattern) => (text) => assert.match(text, pattern);
const CHECKS = [
  [/identify/, has(/board +RP2040[^]*axes +4/)],
  [/load my.toml/, has(/settings/i)],
  [/bring-up inputs/, has(/enable closed +stop inactive +start released/)],
  [/bring-up output/, has(/drive-enable active[^]*drive-enable inactive/)],
  [/bring-up axis/, has(/axes +1,[^]*Only axis 0[^]*axis 0: 3200 steps from index to index, as the settings say/)],
  [/home/, has(/parked/i)],
  [/link restart/, has(/4 axes/)],
  [/monitor/, has(/run/i)],
];

test('a pseudo-terminal is a serial port for the command', { skip: skip || (spawnSync('socat', ['-V']).error ? 'socat is not installed' : false) }, async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'cophase-pty-'));
  const bridge = new Bridge();
  const port = (await bridge.line('port ')).slice(5);
  const tty = path.join(folder, 'tty');
  const socat = spawn('socat', [`pty,link=${tty},raw,echo=0`, `tcp:127.0.0.1:${port}`], { stdio: 'inherit' });
  try {
    while (!fs.existsSync(tty)) await new Promise((resolve) => setTimeout(resolve, 20));
    const { status, text } = await run('cophase link identify', folder, tty);
    assert.equal(status, 0, text);
    assert.match(text, /board +RP2040/);
  } finally {
    socat.kill();
    await bridge.end();
    fs.rmSync(folder, { recursive: true });
  }
});

test('the UF2 file places the bytes of the firmware in the flash', { skip }, () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'cophase-uf2-'));
  const file = path.join(folder, 'firmware.uf2');
  try {
    const done = spawnSync(INSPECT, ['uf2', FIRMWARE, file], { encoding: 'utf8' });
    assert.equal(done.status, 0, done.stderr);
    const expected = new Uint8Array(FLASH_SIZE).fill(0xff);
    loadInto(expected, readElf(fs.readFileSync(FIRMWARE)));
    const flash = Buffer.alloc(FLASH_SIZE, 0xff);
    const bytes = fs.readFileSync(file);
    const blocks = bytes.length / 512;
    for (let number = 0; number < blocks; number += 1) {
      const block = bytes.subarray(512 * number, 512 * (number + 1));
      const word = (at) => block.readUInt32LE(at);
      assert.deepEqual([word(0), word(4), word(8), word(16), word(20), word(24), word(28), word(508)], [0x0a324655, 0x9e5d5157, 0x2000, 256, number, blocks, 0xe48bff56, 0x0ab16f30]);
      block.copy(flash, word(12) - 0x1000_0000, 32, 288);
    }
    assert.ok(flash.equals(expected));
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
});
