// Single faults of the board: each ends with the drives off within its time, and the reason in the log.
//
// A machine of four axes turns at a constant speed. Then one part of the board fails. Two facts that do not depend on each other disagree
// from then on, and a witness detects it (firmware/src/board/witness.rs). docs/safety.md has the table of these faults. The same
// disturbances with all parts working follow: nothing is reported.

import { SETTINGS, requests } from '../bench/frames.mjs';
import { WITNESS_CYCLES } from '../bench/goals.mjs';
import { scene, settingsOf } from '../bench/host.mjs';
import { LinkHost } from '../bench/link-host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { Named } from '../bench/profile.mjs';
import { Snapshot } from '../board/snapshot.mjs';

export const title = 'Single faults of the board: drives off, and the reason in the log';

const TICK_S = 500e-6;

/** Time from a failure to the first ticks after the restart. */
const RESTARTED_S = 0.2;

/** The code of all witnesses in a tick: the board's, and the settings' (docs/safety.md). */
const WITNESSES = /::witness::|check_settings|::checksum::/;

export function run(outcome) {
  const played = scene('hold');
  const settings = settingsOf(played);
  const options = { ...played, settings };
  for (const [name, disturb, reason, maxS] of FAULTS) {
    const machine = turning(options);
    disturb(machine);
    const wrong = [];
    const text = ends(machine, reason, maxS, (holds, what) => holds || wrong.push(what));
    say(outcome, name, text);
    report(outcome, name, wrong, machine);
  }
  for (const [name, act] of SOUND) {
    const machine = turning(options);
    act(machine);
    machine.run(0.5);
    isSound(outcome, name, machine);
  }
  stores(outcome, options);
  inverted(outcome);
  persistent(outcome, turning(options));
  openings(outcome, turning(options));
  cost(outcome, options);
}

/** A machine that has turned for a quarter of a second. */
function turning(options) {
  const machine = new Machine(options);
  machine.boot();
  machine.start();
  machine.run(0.25);
  machine.happened = machine.board.cycle;
  return machine;
}

function isSound(outcome, name, machine) {
  const resets = machine.board.events.filter(({ kind }) => kind === 'reset').length;
  say(outcome, name, 'nothing is reported');
  report(outcome, name, resets === 1 ? [] : ['a witness resets the controller'], machine);
}

const say = (outcome, name, text) => outcome.say(`${name.padEnd(42)} ${text}`);

function report(outcome, name, wrong, machine) {
  const lines = wrong.length > 0 ? log(machine.board) : [];
  for (const text of wrong) outcome.check(false, `${name}: ${text}; the log:\n    ${lines.slice(-6).join('\n    ')}`);
}

/** Drives off in time, and off after the restart; the log has the reason; a reset and a start work again if the fault is over. */
function ends(machine, reason, maxS, must) {
  const { board } = machine;
  machine.run(maxS + RESTARTED_S);
  const [fall = Infinity] = board.edges.to('enable', 0).filter((cycle) => cycle >= machine.happened);
  const seconds = (fall - machine.happened) / CYCLES_PER_S;
  must(seconds <= maxS, `the drives are off within ${ms(maxS)} ms, not ${ms(seconds)}`);
  must(board.edges.to('enable', 1).every((cycle) => cycle < fall), 'the drives stay off');
  const resets = board.events.filter(({ kind, text }) => kind === 'reset' && text === 'watchdog').map(({ cycle }) => cycle);
  must(resets.length > 0, 'the watchdog resets it');
  must(machine.level('enable') === 0, 'the drives are off after the restart');
  const lines = log(board);
  const last = lines.find((line) => /reset by the watchdog/.test(line)) ?? '';
  must(last.includes('Run') && last.includes(`failure: ${reason}`), `the log says reset by the watchdog, Run, ${reason}`);
  must(lines.some((line) => /fault: watchdog-reset/.test(line)), 'the log says watchdog-reset');
  machine.set(pins.ENABLE, 0);
  machine.run(0.05);
  machine.press();
  must(machine.level('enable') === 0, 'a reset does not switch the drives on');
  machine.press();
  must(machine.level('enable') === 1, 'after a reset, a start does');
  return `drives off after ${ms(seconds)} ms, within ${ms(maxS)}: ${reason}`;
}

const ms = (seconds) => Number((seconds * 1000).toPrecision(3));

// ---- the guard ----

const PIO1_CTRL = 0x5030_0000;
const GUARD_MACHINE = 3;

function stopGuard({ board }) {
  board.poke(PIO1_CTRL, board.peek(PIO1_CTRL) & ~(1 << GUARD_MACHINE));
}

/** Opens ENABLE so many cycles after a deadline. */
function openEnable(machine, cycles) {
  const [last] = machine.ticks().slice(-1);
  machine.happened = last.entry + machine.tick + cycles;
  machine.set(pins.ENABLE, 1, machine.happened);
}

/** A host stores settings: interrupts are disabled while the flash is erased, for many periods of SysTick. */
function stores(outcome, options) {
  const machine = new Machine(options);
  machine.boot();
  machine.set(pins.ENABLE, 1);
  const host = new LinkHost(machine, 'usb');
  host.connect();
  host.ask(requests.takeControl());
  host.writeFile(SETTINGS, options.settings);
  machine.run(0.1);
  isSound(outcome, 'settings are stored', machine);
}

/** The guard stands on a machine whose lines have the other active levels. */
function inverted(outcome) {
  const wiring = { enable: 'high', drive_enable: 'low' };
  const played = scene('hold', (toml) => Object.assign(toml, { wiring }));
  const machine = turning({ ...played, settings: settingsOf(played) });
  stopGuard(machine);
  const [seconds, failed] = opened(machine, machine.tick / 2);
  outcome.check(seconds <= GUARD_LOOP_S && failed === GUARD_FAILED, `inverted lines: drives off after ${ms(seconds)} ms, failure ${failed}`);
  say(outcome, '… with inverted lines', `drives off after ${ms(seconds)} ms`);
}

/** Opens ENABLE. Gives the time until the drives are off, and the number of the failure, 0 if there is none. */
function opened(machine, cycles) {
  const { board } = machine;
  openEnable(machine, cycles);
  machine.run(4 * TICK_S);
  const [fall = Infinity] = board.edges.to('enable', 0).filter((cycle) => cycle >= machine.happened);
  return [(fall - machine.happened) / CYCLES_PER_S, (board.peek(WATCHDOG_SCRATCH0) >>> 8) & 0xff];
}

/** The crystal has another rate, also after each restart. */
function persistent(outcome, machine) {
  const { board } = machine;
  const fast = () => board.chip.ticks.change({ rate: 1.01 });
  const resets = () => board.events.filter(({ text }) => text === 'watchdog').length;
  for (let count = 0; count < 3; count += 1) {
    fast();
    board.run({ cycles: CYCLES_PER_S, until: () => resets() > count });
  }
  const falls = board.edges.to('enable', 0).filter((cycle) => cycle >= machine.happened);
  const rises = board.edges.to('enable', 1).filter((cycle) => cycle >= machine.happened);
  outcome.check(resets() === 3, `the board restarts again and again, not ${resets()} times`);
  outcome.check(falls.length === 1 && rises.length === 0, `the drives fall once and stay off, not ${falls.length} and ${rises.length} edges`);
  say(outcome, 'crystal 1 % fast for good', `${resets()} restarts, drives off`);
}

/** Opens ENABLE at every third cycle around the reading of the loop, with the guard and without. */
function openings(outcome, machine) {
  const snapshot = new Snapshot(machine.board);
  const after = { guarded: [], unguarded: [] };
  for (const [name, falls] of Object.entries(after)) {
    for (let cycles = 0; cycles < READING_CYCLES; cycles += 3) {
      snapshot.restore();
      if (name === 'unguarded') stopGuard(machine);
      const [seconds, failed] = opened(machine, cycles);
      falls.push(seconds);
      outcome.check(failed === (name === 'guarded' ? 0 : GUARD_FAILED), `${name}, opened ${cycles} cycles after a deadline: failure ${failed}`);
    }
  }
  const [guarded, unguarded] = [Math.max(...after.guarded), Math.max(...after.unguarded)];
  outcome.check(guarded <= GUARD_S, `the guard cuts within ${ms(GUARD_S)} ms, not ${ms(guarded)}`);
  outcome.check(unguarded <= GUARD_LOOP_S, `the loop cuts within ${ms(GUARD_LOOP_S)} ms, not ${ms(unguarded)}`);
  outcome.say(`enable lost at every third cycle of a reading: drives off within ${ms(guarded)} ms, without the guard within ${ms(unguarded)}`);
}

/** Cycles from a deadline to some time after the loop's reading. */
const READING_CYCLES = 420;
const WATCHDOG_SCRATCH0 = 0x4005_800c;
/** Number of the failure (firmware/src/board/failure.rs). */
const GUARD_FAILED = 3;

/** Noise on ENABLE that is high at each reading: the deadlines of half a second, and some time after them. */
function noiseAtReadings(machine) {
  const [last] = machine.ticks().slice(-1);
  const noise = Math.round(8e-6 * CYCLES_PER_S);
  for (let i = 1; i <= 900; i += 1) {
    const read = last.entry + i * machine.tick + 100 + (i % 40) * 10;
    machine.board.stimulus.pulse(read - noise / 2, pins.ENABLE, noise);
  }
}

// ---- the clocks ----

const TIMER_PAUSE = 0x4005_4030;
const WATCHDOG_TICK = 0x4005_802c;
const TICK_ENABLE = 1 << 9;

const poke = (address, value) => ({ board }) => board.poke(address, value);
const crystal = (rate) => ({ board }) => board.chip.ticks.change({ rate });

/** The timer stops in the middle of a tick, or in the cycle in which SysTick raises its exception. */
const stopTicks = (atException) => (machine) => {
  const { board } = machine;
  const cycle = atException ? board.chip.ppb.systick.zeroAt + board.chip.ppb.systick.reload + 1 : board.cycle;
  board.run({ untilCycle: cycle });
  machine.happened = board.cycle;
  board.poke(WATCHDOG_TICK, board.peek(WATCHDOG_TICK) & ~TICK_ENABLE);
};

/** The timer stops while the loop waits for it with interrupts disabled, to start the step machines again after a missed deadline. */
function stopAtRelease(machine) {
  const { board } = machine;
  const on = () => board.pio[0].machines[0].enabled;
  machine.freeze(0.00105);
  while (on()) board.run({ cycles: 50 });
  machine.happened = board.cycle;
  board.poke(WATCHDOG_TICK, board.peek(WATCHDOG_TICK) & ~TICK_ENABLE);
}

// ---- memory ----

/** Flips a bit of code in RAM that is not executed: of the first function whose name matches. */
const flip = (pattern) => ({ board }) => {
  const found = [...board.elf.symbols.values()].find(({ name, address }) => pattern.test(name) && address >>> 28 === 2);
  board.sram[(found.address & 0xff_ffff) + 4] ^= 0x10;
};

/** Moves the stack to its end, so that the next interrupt runs over it: `room` bytes are left. */
const lowerStack = (room) => ({ board }) => {
  while (board.core.IPSR !== 0 || !board.core.waiting) board.run({ cycles: 10 });
  board.core.registers[13] = board.elf.symbols.get('_stack_end').address + room;
};

/** The stack has run over its end, and is back. */
function writeBeyondStack({ board }) {
  board.poke(board.elf.symbols.get('_stack_end').address, 0x1234_5678);
}

/** Time of SysTick's exception, and the longest tick: a reading of the loop comes as much after its deadline. */
const PERIOD_S = 2 ** 20 / CYCLES_PER_S;
const READ_S = 50e-6;
const ROUND_S = 0.7;
const GUARD_S = 10e-6;
const GUARD_LOOP_S = 2 * TICK_S + READ_S;

/** Time until a rate is 8 µs off, and up to a tick until it is detected. */
const until = (rate) => 8e-6 / Math.abs(1 - rate) + 2 * TICK_S;

/** [name, what fails, the reason in the log, the time until the drives are off]. */
const FAULTS = [
  ['guard stands, then enable lost', (machine) => (stopGuard(machine), openEnable(machine, machine.tick / 2)), 'Guard', GUARD_LOOP_S],
  ['timer without ticks', stopTicks(false), 'Clock', PERIOD_S + READ_S],
  ['… from an exception of SysTick on', stopTicks(true), 'Clock', 2 * PERIOD_S + READ_S],
  ['… while step machines are started', stopAtRelease, 'Clock', PERIOD_S + READ_S],
  ['timer paused', poke(TIMER_PAUSE, 1), 'Clock', PERIOD_S + READ_S],
  ['crystal 1 % fast', crystal(1.01), 'Clock', until(1.01)],
  ['crystal 1 % slow', crystal(0.99), 'Clock', until(0.99)],
  ['a tick of 13 cycles', poke(WATCHDOG_TICK, TICK_ENABLE | 13), 'Clock', until(12 / 13)],
  ['a tick of 6 cycles: twice the rate', poke(WATCHDOG_TICK, TICK_ENABLE | 6), 'Clock', until(2)],
  ['a tick of 511 cycles', poke(WATCHDOG_TICK, TICK_ENABLE | 511), 'Clock', PERIOD_S + READ_S],
  ['a bit of code in RAM', flip(/panic_bounds_check/), 'Code', ROUND_S],
  ['stack at its end', lowerStack(40), 'Stack', TICK_S + READ_S],
  ['stack was beyond its end', writeBeyondStack, 'Stack', TICK_S + READ_S],
];

/** The same without a fault. */
const SOUND = [
  ['enable lost, with its guard', (machine) => openEnable(machine, machine.tick / 2)],
  ['noise on enable at each reading', noiseAtReadings],
  ['processor stands for a period of SysTick', (machine) => machine.freeze(PERIOD_S)],
  ['a tick of 12 cycles', poke(WATCHDOG_TICK, TICK_ENABLE | 12)],
  ['all code as it was placed, for some rounds', (machine) => machine.run(2 * ROUND_S)],
];

// ---- cost ----

/** Cycles of all witnesses in a tick, by the profile of a machine that turns. */
function cost(outcome, options) {
  const machine = new Machine({ ...options, options: { profile: true } });
  machine.boot();
  machine.start();
  machine.run(0.25);
  const from = machine.board.cycle;
  machine.run(0.1);
  const { profile } = machine.board;
  const named = new Named(profile);
  const isWitness = named.stacks.map(({ written }) => written.some((name) => WITNESSES.test(name)));
  const costs = profile.calls.filter(({ entry }) => entry >= from).map(({ cycles }) => {
    let sum = 0;
    for (let i = 0; i < cycles.length; i += 2) if (isWitness[cycles[i]]) sum += cycles[i + 1];
    return sum;
  });
  outcome.check(Math.min(...costs) > 0, 'the profile has the cycles of the witnesses');
  outcome.goal('witnesses of single faults, cycles of a tick at most', Math.max(...costs), WITNESS_CYCLES);
}
