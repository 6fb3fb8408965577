// The board behind a TCP port: bytes there and back, one client at a time, and the effects of cable and power on a
// client.

import assert from 'node:assert/strict';
import { once } from 'node:events';
import net from 'node:net';
import path from 'node:path';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';
import { linkTo } from '../bench/link.mjs';
import { Operator } from '../bench/operator.mjs';
import { HERE } from '../bench/paths.mjs';
import * as pins from '../bench/pins.mjs';
import { Server } from '../bench/serve.mjs';
import { Board } from '../board/board.mjs';
import { UsbDriver } from '../support/usb-driver.mjs';

const MS = 125_000;
const TIMES = { debounce: 1, reset: 1, recovery: 1, resume: 1, address: 0.1 };

/** No cranks. */
const CRANKS = { place() {} };

/** Time on the board's clock after which a test that still waits ends. */
const MAX_S = 30;

/** A served board with the driver that sends everything back; `lines` are the server's reports. */
async function served() {
  const board = new Board({ bare: true });
  const driver = new UsbDriver(board).start();
  const link = linkTo(board, { transport: 'usb', times: TIMES });
  const lines = [];
  let ended = 0;
  const server = new Server(board, link, { fast: true, report: (line) => lines.push(line), ended: () => (ended += 1) });
  board.run({ cycles: 20 * MS, until: () => link.ready });
  const machine = { board, set: (pin, level, cycle = board.cycle) => board.stimulus.at(cycle, pin, level) };
  const operator = new Operator(machine, CRANKS, link, 'usb');
  const port = await server.listen(0);
  server.run();
  const guard = () => {
    if (server.seconds > MAX_S) server.close();
    if (!server.closing) setImmediate(guard);
  };
  guard();
  const reported = async (line) => {
    for (let i = 0; i < 5000 && !lines.includes(line); i += 1) await new Promise(setImmediate);
    assert.ok(lines.includes(line), `"${line}" is reported; there is ${lines.join(', ')}`);
    lines.splice(0, lines.indexOf(line) + 1);
  };
  return { board, driver, link, server, operator, port, reported, get ended() { return ended; } };
}

async function connect(port) {
  const socket = net.connect(port, '127.0.0.1');
  await once(socket, 'connect');
  return socket;
}

async function exchange(socket, bytes) {
  const received = [];
  socket.write(bytes);
  for await (const data of socket.iterator({ destroyOnReturn: false })) {
    received.push(...data);
    if (received.length >= bytes.length) break;
  }
  return Buffer.from(received);
}

const bytesOf = (count) => Buffer.from(Array.from({ length: count }, (_, i) => (i * 37 + (i >> 8)) & 0xff));

/** If this fails, bytes are lost where the board is slower than its client, or DTR does not follow the client. */
test('bytes are echoed unchanged, and DTR shows whether a client is connected', async () => {
  const { server, port, driver, reported } = await served();
  for (let i = 0; i < 2; i += 1) {
    const socket = await connect(port);
    assert.deepEqual(await exchange(socket, bytesOf(20_000)), bytesOf(20_000));
    socket.destroy();
    await reported('event client left');
  }
  for (let i = 0; i < 200; i += 1) await new Promise(setImmediate);
  assert.deepEqual(driver.lines, [3, 0, 3, 0]);
  server.close();
});

/** If this fails, two clients share a port, which a serial port does not allow. */
test('a second client is refused while the first is there', async () => {
  const { server, port, reported } = await served();
  const first = await connect(port);
  await reported('event client');
  const second = await connect(port);
  await once(second, 'close');
  await reported('event refused: there is a client already');
  assert.deepEqual(await exchange(first, bytesOf(10)), bytesOf(10));
  server.close();
  await once(first, 'close');
});

/** If this fails, a client waits for ever for a board that is gone, or gets no board after it is back. */
test('unplugging or a power cut disconnects the client, and the next client can connect again', async () => {
  const { server, port, operator, reported, board, driver } = await served();
  const losses = [
    ['unplug', 'plug', () => {}],
    ['power-cut', 'power-up', () => driver.start()],
  ];
  for (const [off, on, boot] of losses) {
    const socket = await connect(port);
    await reported('event client');
    operator.obey(off);
    await once(socket, 'close');
    await reported('event gone');
    const early = await connect(port);
    await once(early, 'close');
    await reported('event refused: the port is not there');
    operator.obey(on);
    boot();
    await reported('event ready');
    const next = await connect(port);
    assert.deepEqual(await exchange(next, bytesOf(100)), bytesOf(100), on);
    next.destroy();
    await reported('event client left');
  }
  assert.ok(board.powered);
  server.close();
});

/** If this fails, a command has another effect, or fails without a message. */
test('commands set inputs and drive the bus, and impossible commands are errors', async () => {
  const rig = await served();
  const { server, operator, board, driver, port } = rig;
  operator.obey('enable  off');
  board.run({ cycles: MS });
  assert.equal((board.pads.levels >>> pins.ENABLE) & 1, 1);
  operator.obey('enable on');
  operator.obey('press start');
  board.run({ cycles: MS });
  assert.equal((board.pads.levels >>> pins.ENABLE) & 1, 0);
  assert.equal((board.pads.levels >>> pins.START) & 1, 0, 'the button is down');
  board.run({ cycles: 60 * MS });
  assert.equal((board.pads.levels >>> pins.START) & 1, 1, 'and released');
  driver.events.length = 0;
  operator.obey('suspend');
  board.run({ cycles: 10 * MS });
  operator.obey('resume');
  board.run({ cycles: 10 * MS });
  assert.deepEqual(driver.events, ['suspend', 'resume']);
  assert.throws(() => operator.obey('resume'), /not suspended/);
  assert.throws(() => operator.obey('power-up'), /on already/);
  assert.throws(() => operator.obey('jump'), /no command is called jump: use one of plug,/);
  assert.throws(() => new Operator(operator.machine, CRANKS, operator.link, 'uart').obey('unplug'), /--transport usb/);
  const socket = await connect(port);
  assert.deepEqual(await exchange(socket, bytesOf(10)), bytesOf(10));
  server.close();
  server.close();
  assert.equal(rig.ended, 1, 'it ends once');
});

/** If this fails, a wrong argument is taken for another, or its message gives no remedy. */
test('errors in arguments of the bridge name the argument and its allowed values', () => {
  for (const [args, message] of [
    [['--transport', 'tin'], /--transport is tin: give one of usb, uart/],
    [['--port', '70000'], /--port is 70000: give a whole number from 0 to 65535/],
    [['--scene', 'nowhere'], /--scene is nowhere, which does not exist: give a file/],
    [['--elf', '/nowhere'], /--elf is \/nowhere, which does not exist: build/],
    [['--sceen', 'x'], /--sceen/],
  ]) {
    const done = spawnSync(process.execPath, [path.join(HERE, 'bridge.mjs'), ...args], { encoding: 'utf8' });
    assert.equal(done.status, 2);
    assert.match(done.stderr, message);
  }
});
