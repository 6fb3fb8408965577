// Commands to the surroundings of a running board, one a line: its cable, its power, its inputs.

import { CYCLES_PER_S } from './machine.mjs';
import * as pins from './pins.mjs';

const PRESSED_S = 0.05;
/**
 * Time after a switch until the link judges requests by the new state. It samples the state every 10 ms, and takes samples every 2 ms.
 */
const SWITCHED_S = 0.02;

export class Operator {
  /** `machine`: a Machine, with its `cranks`; `link`: of link.mjs; `transport`: 'usb' or 'uart'. */
  constructor(machine, cranks, link, transport) {
    Object.assign(this, { machine, link, transport });
    this.commands = {
      plug: () => this.usb('plug'),
      unplug: () => this.usb('unplug'),
      'reset-bus': () => this.usb('resetBus'),
      suspend: () => this.usb('suspend'),
      resume: () => this.usb('resume'),
      'power-cut': () => this.power(false),
      'power-up': () => this.power(true),
      'press start': () => this.press(),
      'enable on': () => this.switchEnable(0),
      'enable off': () => this.switchEnable(1),
      'place cranks': () => cranks.place(),
    };
  }

  /** Carries out a command. Throws if no command has that name, or if it is not possible now. */
  obey(line) {
    const command = this.commands[line.trim().replace(/\s+/g, ' ')];
    if (!command) throw new Error(`no command is called ${line.trim()}: use one of ${Object.keys(this.commands).join(', ')}`);
    command();
  }

  usb(method) {
    if (this.transport !== 'usb') throw new Error('the link is a UART, which has no bus: start the bridge with --transport usb');
    this.link[method]();
  }

  power(on) {
    const { board } = this.machine;
    if (board.powered === on) throw new Error(`the power is ${on ? 'on' : 'off'} already`);
    if (on) board.powerUp();
    else board.powerDown();
  }

  /** Switches the enable input, and waits until the firmware has had time to report the new state. */
  switchEnable(level) {
    this.machine.set(pins.ENABLE, level);
    this.machine.board.run({ cycles: SWITCHED_S * CYCLES_PER_S });
  }

  press() {
    const { machine } = this;
    const { cycle } = machine.board;
    machine.set(pins.START, 0);
    machine.set(pins.START, 1, cycle + Math.round(PRESSED_S * CYCLES_PER_S));
  }
}
