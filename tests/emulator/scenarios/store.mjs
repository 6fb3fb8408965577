// Store: the firmware's treatment of settings files that it finds, and the effects of a power cut while it writes one.
//
// For any content of the flash, the firmware either runs on complete settings, or refuses to run. If it refuses, it keeps the
// drives off for any input, and logs the reason. After a cut at any point of storing, the next start runs from the flash.

import { crc32 } from '../bench/crc.mjs';
import { varint } from '../bench/frames.mjs';
import { scene, settingsOf } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { flashWith, Machine } from '../bench/machine.mjs';

/** Offsets in a settings file's header (docs/settings-file.md). */
const HEADER_BYTES = 256;
const VERSION_AT = 8;
const SEQUENCE_AT = 16;
const ORIGIN_AT = 20;

/** The shortest flash operations: only their order matters here. */
const QUICK = { flashTimes: { eraseSector: 2000, programPage: 500 } };

export const title = 'Store: settings found, refused, stored, and torn by power cuts';

/** A format version that the firmware does not read. */
const ANOTHER_VERSION = 999;

export function run(outcome) {
  const settings = settingsOf(scene('hold'));
  refusals(outcome, settings);
  stores(outcome, settings);
  cuts(outcome, settings);
}

/** A machine on a flash, powered up; its number of axes does not matter here. */
const powered = (flash) => new Machine({ axes: 6, tickHz: 2000, flash, options: QUICK });

// ---- refused files ----

function refusals(outcome, settings) {
  const flipped = Buffer.from(settings);
  flipped[HEADER_BYTES + 37] ^= 0x10;
  const newer = withHeader(settings, (header) => header.writeUInt16LE(ANOTHER_VERSION, VERSION_AT));
  const servo = settingsOf(scene('hold', (toml) => (toml.axis[0].drive = 'servo')));
  const counting = settingsOf(scene('hold', (toml) => (toml.axes.encoder = true)));
  for (const [name, bytes, reason] of [
    ['a bit of the payload', flipped, /settings-rejected: PayloadCrc/],
    ['another version', newer, new RegExp(`settings-rejected: Version.*${ANOTHER_VERSION}`)],
    ['a servo axis', servo, /settings-rejected: Unfit\(Servo\(2\)\)/],
    ['an encoder', counting, /settings-rejected: Unfit\(Encoder\(0\)\)/],
    ['a program too quick', quick(settings), /program-rejected: Settings\(SettingsError.*program\.amax_mps2/],
    ['a tick too short', hasty(settings), /settings-rejected: Unfit\(TickTooShort.*tick_hz: 10000/],
  ]) {
    const machine = powered(flashWith(bytes));
    machine.run(0.3);
    machine.press();
    machine.press();
    const lines = log(machine.board);
    outcome.check(lines.some((line) => reason.test(line)), `${name}: the log says ${reason}, not\n    ${lines.join('\n    ')}`);
    outcome.check(machine.board.edges.to('enable', 1).length === 0, `${name}: the drives are never on`);
    outcome.check(machine.board.edges.to('step_0', 1).length === 0, `${name}: nothing moves`);
    outcome.check(machine.board.edges.to('led', 1).length > 0, `${name}: the LED flashes`);
    outcome.say(`${name.padEnd(24)} drives stay off: ${reason.source}`);
  }
}

/** The settings file with its header changed, and the header's own CRC right again. */
function withHeader(settings, change) {
  const changed = Buffer.from(settings);
  change(changed);
  changed.writeUInt32LE(crc32(changed.subarray(0, HEADER_BYTES - 4)), HEADER_BYTES - 4);
  return changed;
}

/** The settings file with other bytes in the place of some in its payload, valid otherwise. */
function withPayload(settings, from, to) {
  const changed = Buffer.from(settings);
  const payload = changed.subarray(HEADER_BYTES);
  const crcAt = changed.indexOf(Buffer.from(Uint32Array.of(crc32(payload)).buffer));
  const at = payload.indexOf(from);
  if (at < 0 || crcAt < 0 || crcAt > HEADER_BYTES) throw new Error('the settings file is not as it was: docs/settings-file.md');
  to.copy(payload, at);
  return withHeader(changed, (header) => header.writeUInt32LE(crc32(payload), crcAt));
}

function double(value) {
  const bytes = Buffer.alloc(8);
  bytes.writeDoubleLE(value);
  return bytes;
}

/** The settings file with a program beyond the limits. */
const quick = (settings) => withPayload(settings, double(8 * 9.80665), double(20_000));

/** The settings file with a tick rate that the board refuses. */
const hasty = (settings) => withPayload(settings, Buffer.from(varint(2000)), Buffer.from(varint(10_000)));

// ---- stored files ----

/** Starts the firmware on a flash; it must reach the loop. Gives the log and the number of flash operations. */
function starts(outcome, name, flash) {
  const machine = powered(flash);
  let lines = [];
  try {
    machine.boot();
    outcome.check(machine.board.edges.to('enable', 1).length === 0, `${name}: nothing moves before the button is pressed`);
    machine.press();
    machine.run(LOG_S);
    lines = log(machine.board);
    outcome.check(machine.level('enable') === 1, `${name}: pressing it switches the drives on`);
  } catch (error) {
    outcome.check(false, `${name}: ${error.message}; the log:\n    ${log(machine.board).join('\n    ')}`);
  }
  return { lines, operations: machine.board.rom.operations.length };
}

/** Notes are in the log within this time (firmware/src/report.rs). */
const LOG_S = 0.006;

const says = (lines, pattern) => lines.some((line) => pattern.test(line));

function stores(outcome, settings) {
  const flash = flashWith();
  const first = starts(outcome, 'empty flash', flash);
  outcome.check(says(first.lines, /stored in slot A/), 'an empty flash: what is built in is stored');
  const second = starts(outcome, 'second start', flash);
  outcome.check(says(second.lines, /settings from slot A/), 'the second start takes what was stored');
  outcome.check(second.operations === 0, 'and writes nothing');
  const placed = starts(outcome, 'placed settings file', flashWith(settings));
  outcome.check(says(placed.lines, /settings: hold, 4 axes/), 'a settings file that was placed is run');
  outcome.check(placed.operations === 0, 'and nothing is written');
  outcome.say('empty flash: built-in settings run and are stored; the next start takes them from there');
  outcome.say('a settings file that was placed from outside is run as it is');
}

// ---- effects of a power cut ----

const CUT_AFTER = [0, 1, 97, 255, 2048, 4095];

function cuts(outcome, settings) {
  const older = withHeader(settings, (header) => {
    header.writeUInt32LE(7, SEQUENCE_AT);
    header.writeUInt32LE(0x1234_5678, ORIGIN_AT); // stored by another firmware
  });
  let count = 0;
  for (const [name, fresh] of [['empty flash', () => flashWith()], ['older settings', () => flashWith(older)]]) {
    for (let operation = 0; ; operation += 1) {
      const torn = CUT_AFTER.map((bytes) => cut(outcome, `${name}, cut in operation ${operation} after ${bytes}`, fresh(), { operation, bytes }));
      count += torn.filter(Boolean).length;
      if (!torn.some(Boolean)) break;
    }
  }
  outcome.check(count > 40, `at least 40 cuts are tried, not ${count}`);
  outcome.say(`${count} power cuts while storing: every next start ran, on whole settings`);
}

/** Cuts the power, and starts again twice. Gives whether the cut occurred. */
function cut(outcome, name, flash, where) {
  const machine = powered(flash);
  machine.board.rom.cutPower(where);
  if (machine.run(0.4).reason !== 'power-cut') return false;
  outcome.check(machine.board.edges.to('enable', 1).length === 0, `${name}: the drives were never on`);
  const again = starts(outcome, name, flash);
  outcome.check(says(again.lines, /settings: (default|hold), 4 axes/), `${name}: the next start runs`);
  const third = starts(outcome, name, flash);
  outcome.check(third.operations === 0, `${name}: the start after that writes nothing`);
  return true;
}

