// The cranks that follow a running board, against the host's: their index lines must be those that it predicts.

import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { Cranks } from '../bench/cranks.mjs';
import { predict, scene, settingsOf } from '../bench/host.mjs';
import { Machine } from '../bench/machine.mjs';
import { COPHASE, FIRMWARE } from '../bench/paths.mjs';
import * as pins from '../bench/pins.mjs';

const built = [FIRMWARE, COPHASE].every((file) => fs.existsSync(file));

/** The scene's flags have no length. Here they get a length, and one of them is before its sensor at power-up. */
function withLengths(toml) {
  toml.axes.index_width_deg = 10;
  toml.axis.find(({ number }) => number === 1).index_deg = -5;
}

/** The edges of the index lines of `count` axes, as { cycle, level } from `began` on, of cranks that follow the board. */
function play(played, seconds) {
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const { board } = machine;
  const lines = Array.from({ length: played.axes }, () => []);
  const began = machine.start();
  const cranks = new Cranks(board, played.toml);
  const record = cranks.record.bind(cranks);
  cranks.record = (stamp, changed) => {
    for (let axis = 0; axis < played.axes; axis += 1) {
      const pin = pins.INDEX[axis];
      if ((changed >>> pin) & 1) lines[axis].push({ cycle: stamp - began, level: (board.pads.levels >>> pin) & 1 });
    }
    record(stamp, changed);
  };
  machine.run(seconds);
  return lines;
}

/** If this fails, a crank is elsewhere than its firmware drove it, and homing on the bridge fails or means nothing. */
test('index lines come at the cycles that the host predicts', { skip: !built && 'no firmware or command built' }, () => {
  for (const change of [() => {}, withLengths]) {
    const played = scene('index', change);
    const predicted = predict(played);
    // The host records the beginning of a flag, but not its length.
    const rises = (edges) => edges.filter(({ level }) => level === 1).map(({ cycle }) => cycle);
    play(played, 1).forEach((line, axis) => {
      const expected = rises(predicted.edges.get(`index_${axis}`));
      const actual = rises(line).filter((cycle) => cycle >= expected[0]);
      assert.equal(actual.length, expected.length, `axis ${axis}`);
      const offset = actual[0] - expected[0];
      assert.ok(offset < 30, `axis ${axis} begins ${offset} cycles off`);
      actual.forEach((cycle, i) => assert.equal(cycle - offset, expected[i], `axis ${axis}, passage ${i}`));
      const [first] = line;
      assert.equal(first.level, 1);
      if (change === withLengths && axis === 1) assert.ok(first.cycle < expected[0] / 10, 'the flag is before the sensor at first');
    });
  }
});
