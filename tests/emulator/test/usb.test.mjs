// The USB device controller with its bus and host, used by a driver that acts like embassy-rp.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { CdcHost } from '../bench/usb-cdc.mjs';
import { Board } from '../board/board.mjs';
import { Snapshot } from '../board/snapshot.mjs';
import { transactionCycles } from '../board/usb-port.mjs';
import * as u from '../support/usb-driver.mjs';

const MS = 125_000;
const [OUT, IN] = [1, 2];
const bytesOf = (count) => Array.from({ length: count }, (_, i) => (i * 37 + (i >> 8)) & 0xff);

/** A board with the driver, and a host with times that are short where nothing depends on them. */
function rig({ options, plugged = true } = {}) {
  const board = new Board({ bare: true });
  const driver = new u.UsbDriver(board, options).start();
  const host = new CdcHost(board, { debounce: 1, reset: 1, recovery: 1, resume: 1, address: 0.1, request: 20 });
  const data = [];
  host.onData = (bytes) => data.push(...bytes);
  const ready = () => board.run({ cycles: 20 * MS, until: () => host.ready });
  if (plugged) {
    host.plug();
    ready();
    assert.ok(host.ready, 'the device is configured');
  }
  const wait = (ms) => board.run({ cycles: ms * MS });
  return { board, driver, host, data, ready, wait };
}

/** Sends bytes, and gives the bytes that came back within so many milliseconds. */
function echo({ board, host, data }, bytes, ms = 50) {
  data.length = 0;
  host.send(bytes);
  board.run({ cycles: ms * MS, until: () => data.length >= bytes.length });
  return [...data];
}

/** If this fails, the controller gives buffers to the firmware before a packet has arrived, and each counts as a packet. */
test('an OUT buffer stays with the controller until a packet of the host has filled it', () => {
  const { board, driver, host, wait } = rig();
  driver.echoing = false;
  wait(5);
  assert.ok(driver.buffer(OUT, true) & u.AVAILABLE);
  assert.equal(driver.read(u.BUFF_STATUS), 0);
  // From a quiet bus in the middle of a frame.
  board.run({ untilCycle: board.usb.frameOrigin + 20 * MS + 5000 });
  driver.poll.cancel();
  const from = board.cycle;
  host.send([1, 2, 3]);
  board.run({ untilCycle: from + transactionCycles(3) - 2 });
  assert.ok(driver.buffer(OUT, true) & u.AVAILABLE, 'not before the packet has passed');
  board.run({ cycles: 4 });
  const buffer = driver.buffer(OUT, true);
  assert.equal(buffer & u.AVAILABLE, 0);
  assert.equal(buffer & u.LENGTH, 3);
  assert.ok(buffer & u.FULL);
  assert.equal(driver.read(u.BUFF_STATUS), 1 << (2 * OUT + 1));
  assert.equal((board.core.lines >>> 5) & 1, 1, 'the interrupt is raised');
  assert.deepEqual([...board.chip.usbDPRAM.slice(driver.memory(OUT), driver.memory(OUT) + 3)], [1, 2, 3]);
});

/**
 * If this fails, packets take another time than at full speed: USB 2.0, table 5-9, has 19 of 64 bytes in a frame, and 71 of none.
 */
test('a frame has as many packets as the specification allows', () => {
  const { board, driver, host } = rig();
  driver.echoing = false;
  driver.poll.cancel();
  for (const [size, max] of [[64, 19], [8, 71]]) {
    let sent = 0;
    host.onSent = () => {
      sent += 1;
      driver.give(OUT, true, (~driver.buffer(OUT, true) & u.DATA1) | 64);
    };
    board.run({ untilCycle: board.usb.frameOrigin + Math.ceil((board.cycle - board.usb.frameOrigin) / MS) * MS });
    for (let i = 0; i < 100; i += 1) host.write(host.bulkOut, bytesOf(size));
    board.run({ cycles: MS });
    assert.equal(sent, max, `packets of ${size} bytes`);
    board.run({ cycles: 10 * MS });
  }
});

/** If this fails, bytes are lost, duplicated or reordered, or a transfer that fills its last packet never ends. */
test('transfers of any length are echoed unchanged, full and empty packets included', () => {
  const all = rig();
  for (const count of [1, 63, 64, 65, 128, 1000, 64 * 40]) assert.deepEqual(echo(all, bytesOf(count)), bytesOf(count), `${count} bytes`);
  assert.equal(all.host.identity.name, 'echo');
  assert.deepEqual(all.host.errors, []);
});

/** If this fails, a host that does not read loses bytes, or the device goes on without it. */
test('a host that does not read blocks the device and receives every byte once it reads', () => {
  const { board, host, data, wait, driver } = rig();
  host.setReading(false);
  host.send(bytesOf(1000));
  wait(20);
  assert.deepEqual(data, []);
  const { pending } = host;
  assert.ok(pending > 700, `the device takes no more than it has room for, ${pending} bytes wait`);
  assert.ok(driver.buffer(IN, false) & u.AVAILABLE);
  host.setReading(true);
  board.run({ cycles: 20 * MS, until: () => data.length === 1000 });
  assert.deepEqual(data, bytesOf(1000));
});

/** If this fails, firmware that does not keep the order of DATA0 and DATA1 passes here, and loses packets with a real host. */
test('a packet with the wrong DATA PID is dropped and reported', () => {
  const { driver, host, wait, data, board } = rig();
  driver.echoing = false;
  driver.give(OUT, true, u.DATA1 | 64);
  host.send([9]);
  wait(1);
  assert.ok(driver.buffer(OUT, true) & u.AVAILABLE, 'the buffer has not been filled');
  assert.equal(driver.read(u.SIE_STATUS) >>> 31, 1);
  host.onError = () => {};
  board.chip.usbDPRAM.set([1], driver.memory(IN));
  driver.give(IN, false, u.DATA1 | u.FULL | 1);
  wait(1);
  assert.deepEqual(data, []);
  assert.match(host.errors[0].text, /endpoint 2 IN.*DATA PID/);
});

/** If this fails, a refused request ends the default pipe for good, or is not reported as refused. */
test('a request that the device refuses is reported, and the next SETUP clears the stall', () => {
  const all = rig();
  const { host, wait, driver } = all;
  const failures = [];
  host.request({ type: 0xc0, request: 99, length: 4 }, () => failures.push('accepted'), (text) => failures.push(text));
  wait(2);
  assert.equal(failures.length, 1);
  assert.match(failures[0], /0x63.*STALL/);
  assert.equal(driver.read(u.EP_STALL_ARM), 3);
  host.open();
  wait(2);
  assert.deepEqual(driver.lines, [3], 'DTR and RTS arrive');
  assert.equal(driver.read(u.EP_STALL_ARM), 0);
});

/** If this fails, a stalled endpoint stays so after the host has cleared it, or answers while it stalls. */
test('a stalled endpoint takes nothing until the host clears it', () => {
  const { host, driver, wait, board } = rig();
  driver.echoing = false;
  driver.stall(OUT, true);
  host.onHalt = () => {};
  host.send([5]);
  wait(2);
  assert.ok(host.bulkOut.halted);
  assert.equal(host.pending, 1);
  host.clearHalt(host.bulkOut);
  board.run({ cycles: 5 * MS, until: () => host.pending === 0 });
  assert.equal(host.pending, 0);
  assert.equal(driver.buffer(OUT, true) & u.LENGTH, 1);
});

/** If this fails, a reset keeps an address or a packet from before it. */
test('a bus reset during a transfer is reported, and the next transfer is complete', () => {
  const all = rig();
  const { host, driver, ready, wait } = all;
  host.send(bytesOf(5000));
  wait(1);
  host.resetBus();
  assert.ok(!host.ready);
  wait(0.5);
  assert.equal(driver.read(u.ADDR_ENDP), 0);
  ready();
  assert.deepEqual(driver.events, ['reset', 'reset']);
  assert.deepEqual(echo(all, bytesOf(500)), bytesOf(500));
  assert.deepEqual(host.errors, []);
});

/** If this fails, the device answers an address that is not its own, or a host that gets no answer waits for ever. */
test('an endpoint without an answer is an error after three tries and is named', () => {
  const { host, driver, wait } = rig();
  host.onError = () => {};
  driver.write(u.ADDR_ENDP, 7);
  host.send([1]);
  wait(1);
  assert.match(host.errors[0].text, /endpoint 2 IN|endpoint 1 OUT/);
  assert.match(host.errors[0].text, /no answer from address 1, 3 times/);
});

/** If this fails, noise duplicates a packet, or loses one. */
test('packets destroyed by noise are sent again and arrive only once', () => {
  const all = rig();
  const { board } = all;
  for (let after = 1; after < 20; after += 1) {
    all.data.length = 0;
    all.host.send(bytesOf(300));
    board.run({ cycles: after * 1500 });
    board.usb.noisy = 1 + (after % 2);
    board.run({ cycles: 5 * MS });
    assert.deepEqual(all.data, bytesOf(300), `noise after ${after * 1500} cycles`);
  }
  assert.deepEqual(all.host.errors, []);
});

/** If this fails, suspend comes with a busy bus, too early or never, or loses data. */
test('suspend is reported after 3 ms without frames, and resume when the host drives it', () => {
  const all = rig();
  const { host, driver, wait, data, board } = all;
  host.send(bytesOf(2000));
  wait(1);
  driver.events.length = 0;
  host.suspend();
  const before = data.length;
  wait(2.9);
  assert.deepEqual(driver.events, []);
  wait(0.2);
  assert.deepEqual(driver.events, ['suspend']);
  wait(20);
  assert.equal(data.length, before, 'nothing comes over a suspended bus');
  assert.throws(() => host.suspend(), /resume it first/);
  host.resume();
  wait(0.1);
  assert.deepEqual(driver.events, ['suspend', 'resume'], 'as the host drives K');
  board.run({ cycles: 20 * MS, until: () => data.length === 2000 });
  assert.deepEqual(data, bytesOf(2000));
  driver.poll.cancel();
  host.suspend();
  wait(4);
  assert.equal(driver.read(u.SIE_STATUS) & (u.SUSPENDED | u.RESUME), u.SUSPENDED);
  host.resume();
  wait(2);
  assert.equal(driver.read(u.SIE_STATUS) & (u.SUSPENDED | u.RESUME), u.RESUME, 'the bus is no longer suspended');
});

/** If this fails, the firmware is informed of the loss of its host in a way that a real controller does not support. */
test('without the cable the bus is idle, which a driver that overrides VBUS takes for suspend', () => {
  const all = rig();
  const { host, driver, wait, ready } = all;
  host.send(bytesOf(5000));
  wait(1);
  let gone = 0;
  host.onGone = () => (gone += 1);
  driver.events.length = 0;
  host.unplug();
  assert.equal(gone, 1);
  wait(20);
  assert.deepEqual(driver.events, ['suspend']);
  assert.equal(driver.read(u.SIE_STATUS) & 1, 1, 'VBUS is overridden');
  host.plug();
  ready();
  assert.deepEqual(driver.events, ['suspend', 'reset']);
  assert.deepEqual(echo(all, bytesOf(700)), bytesOf(700));
});

/** If this fails, the loss of VBUS is not reported to a driver that checks it. */
test('a driver that does not override VBUS detects that the cable is unplugged', () => {
  const all = rig({ options: { override: false }, plugged: false });
  const { host, driver, wait, ready } = all;
  wait(10);
  assert.equal(driver.read(u.SIE_STATUS) & 1, 0);
  assert.deepEqual(driver.events, [], 'no bus, no suspend');
  host.plug();
  ready();
  assert.ok(host.ready);
  assert.equal(driver.read(u.SIE_STATUS) & 1, 1);
  host.unplug();
  wait(10);
  assert.equal(driver.read(u.SIE_STATUS) & 1, 0);
  assert.equal((driver.read(u.INTR) >>> 13) & 1, 1, 'the connection has changed');
});

/** If this fails, a host goes on with a device that has been reset, or a board without power keeps its pull-up. */
test('a watchdog reset or a power cut disconnects the device until its firmware starts again', () => {
  const all = rig();
  const { board, host, driver, ready, wait } = all;
  board.poke(0x4001_0008, 0x1_fffc);
  board.requestReset('watchdog');
  wait(1);
  assert.ok(!host.ready);
  driver.start();
  ready();
  assert.deepEqual(echo(all, [1, 2]), [1, 2]);
  board.powerDown();
  assert.ok(!host.ready);
  wait(5);
  board.powerUp();
  driver.start();
  ready();
  assert.deepEqual(echo(all, [3, 4]), [3, 4]);
  assert.deepEqual(host.errors, []);
});

/** If this fails, a snapshot in the middle of a packet loses it, or duplicates it. */
test('a restored snapshot repeats the same transfer', () => {
  const { board, host, data } = rig();
  host.send(bytesOf(900));
  board.run({ cycles: 30_000 });
  const snapshot = new Snapshot({ board, data });
  const goOn = () => {
    board.run({ cycles: 10 * MS });
    return [...data];
  };
  const first = goOn();
  assert.deepEqual(first, bytesOf(900));
  snapshot.restore();
  assert.deepEqual(goOn(), first);
});

/** If this fails, firmware that needs a feature outside the model runs on a wrong model. */
test('unmodelled USB features are refused by name', () => {
  const { driver, board } = rig({ plugged: false });
  assert.throws(() => driver.write(u.MAIN_CTRL, 3), /host mode/);
  assert.throws(() => driver.write(u.INTE, 1 << 17), /start of frame/);
  assert.throws(() => board.chip.writeUint32(0x5010_0008, (1 << 30) >>> 0), /endpoint 1 IN: two buffers/);
});
