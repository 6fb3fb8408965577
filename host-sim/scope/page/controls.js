// Controls of the machine, each with the reason why it is not possible now.

/** Time between two requests of a jog, ms: less than half the duration of one request. */
const JOG_MS = 200;

const AT_REST = ['idle', 'parked'];

function needsControl(status) {
  if (status.control === 'you') return undefined;
  if (status.control === 'other') return `${status.owner ?? 'another host'} has control`;
  return 'take control first';
}

function needsState(states, status) {
  return states.includes(status.state) ? undefined : `not possible in state ${status.state}`;
}

function needsInputs(status) {
  if (!status.enable) return 'the enable input is open';
  if (status.stop_input) return 'the stop input is active';
  return undefined;
}

function needsArm(status) {
  return needsInputs(status) ?? (status.armed ? undefined : 'arm first');
}

/** Where to stop the machine if this page cannot. */
export const STOP_THERE = 'Use the STOP input or the emergency stop at the machine.';

const REASONS = {
  control: (status) => (status.control === 'other' ? needsControl(status) : undefined),
  arm: (status) => needsControl(status) ?? needsState(AT_REST, status) ?? needsInputs(status),
  start: (status) => needsControl(status) ?? needsState(AT_REST, status) ?? needsArm(status),
  home: (status) => needsControl(status) ?? needsState(['idle'], status) ?? needsArm(status),
  jog: (status) => needsControl(status) ?? needsState(['parked'], status) ?? needsArm(status),
  hold: (status) =>
    needsControl(status) ?? needsState(['run'], status) ?? (status.holding ? 'it holds already' : undefined),
  resume: (status) =>
    needsControl(status) ?? needsState(['run'], status) ?? (status.holding ? undefined : 'nothing is held'),
  reset: (status) => needsControl(status) ?? needsState(['fault'], status),
  override: (status) => needsControl(status),
  load: (status) => needsControl(status) ?? needsState(AT_REST, status),
  inject: (status) => needsControl(status),
  restart: (status) => needsControl(status) ?? (status.drives ? 'the drives are on: stop the machine, and reset a fault' : undefined),
};

const isStop = (action) => action === 'stop' || action === 'stop-now';

/**
 * Returns the reason why an action is not possible in a status; `undefined` if it is. The controller checks everything again.
 * Without contact there is no status. A stop is possible in every status, and is tried if it may reach the controller.
 *
 * @param {{ status?: object, passesStop: boolean }} known
 */
export function reasonAgainst(action, { status, passesStop }) {
  if (isStop(action)) return passesStop ? undefined : `this page cannot reach the controller. ${STOP_THERE}`;
  return status === undefined ? 'there is no contact with the controller' : REASONS[action](status);
}

export class Controls {
  #root;
  #socket;
  #known = { status: undefined, passesStop: false };
  #message;
  #jogging;

  /**
   * @param {HTMLElement} root Element whose descendants with `data-action` are controls.
   * @param {(text: string, isError: boolean) => void} message Shows the result of a request.
   */
  constructor(root, socket, message) {
    this.#root = root;
    this.#socket = socket;
    this.#message = message;
    for (const button of root.querySelectorAll('button[data-action]')) {
      if (button.dataset.action === 'jog') {
        this.#wireJog(button);
      } else if (button.type !== 'submit') {
        // A form handles its own button.
        button.addEventListener('click', () => this.act(button.dataset.action));
      }
    }
    root.addEventListener('keydown', (event) => this.#guardKeys(event));
    const slider = root.querySelector('input[data-action=override]');
    slider.addEventListener('input', () => {
      this.sliderMoved = performance.now();
      this.#showOverride(slider.value);
      this.act('override');
    });
    this.update(this.#known);
  }

  /**
   * Shows the controls that are possible.
   *
   * @param {{ status?: object, passesStop: boolean }} known The status; none without contact.
   */
  update(known) {
    this.#known = known;
    const { status } = known;
    if (status === undefined) this.endJog();
    for (const control of this.#root.querySelectorAll('[data-action]')) {
      const reason = reasonAgainst(control.dataset.action, known);
      // A control that is not possible keeps its focus, and shows the reason when it is used.
      control.setAttribute('aria-disabled', String(reason !== undefined && !this.#jogging));
      control.title = reason === undefined ? (control.dataset.title ?? '') : `Not now: ${reason}`;
    }
    const control = this.#root.querySelector('[data-action=control]');
    const hasControl = status?.control === 'you';
    control.textContent = hasControl ? 'Release' : 'Take control';
    control.setAttribute('aria-pressed', String(hasControl));
    control.dataset.title = hasControl ? 'This page has control' : 'One page commands; the others watch';
    const arm = this.#root.querySelector('[data-action=arm]');
    arm.textContent = status?.armed ? 'Armed' : 'Arm';
    arm.setAttribute('aria-pressed', String(Boolean(status?.armed)));
    // The slider follows the machine, except while a user moves it.
    if (status !== undefined && performance.now() - (this.sliderMoved ?? -1e4) > 1000) {
      const percent = status.override_permille / 10;
      this.#root.querySelector('input[data-action=override]').value = percent;
      this.#showOverride(percent);
    }
  }

  #showOverride(percent) {
    this.#root.querySelector('#override-value').textContent = `${Math.round(percent)} %`;
  }

  /** Carries out an action by its name, if it is possible. */
  async act(action, fields = {}) {
    const reason = reasonAgainst(action, this.#known);
    if (reason !== undefined) {
      this.#message(`${action}: ${reason}`, true);
      return false;
    }
    if (this.#known.status === undefined) {
      this.#message(`${action}: sent, without contact to the controller. ${STOP_THERE}`, true);
    }
    try {
      await this.#request(action, fields);
      this.#message(`${action}: done`, false);
      return true;
    } catch (error) {
      this.#message(error.message, true);
      return false;
    }
  }

  #request(action, fields) {
    const socket = this.#socket;
    switch (action) {
      case 'control':
        return socket.request(this.#known.status.control === 'you' ? 'release-control' : 'take-control');
      case 'arm':
        return socket.request(this.#known.status.armed ? 'disarm' : 'arm');
      case 'stop':
        return socket.request('stop', { now: false });
      case 'stop-now':
        return socket.request('stop', { now: true });
      case 'override': {
        const percent = Number(this.#root.querySelector('input[data-action=override]').value);
        return socket.request('override', { permille: Math.round(10 * percent) });
      }
      default:
        return socket.request(action, fields);
    }
  }

  /**
   * A control takes a click, or Ctrl and a key while it has the focus. So no single key moves the machine, or changes its motion.
   * A stop takes Enter alone.
   */
  #guardKeys(event) {
    const { key, target } = event;
    const control = target.closest('[data-action], form#faults');
    if (!control || isStop(control.dataset.action)) return;
    const isSlider = target.matches('input[type=range]');
    const isPress = key === 'Enter' && !target.matches('select');
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10, Home: -Infinity, End: Infinity };
    if (!isPress && !(isSlider && key in steps)) return;
    event.preventDefault();
    if (event.repeat) return;
    if (!event.ctrlKey && !event.metaKey) {
      this.#message(`hold Ctrl as well: Ctrl+${key.replace('Arrow', '')}`, true);
    } else if (isSlider && key in steps) {
      const { min, max, value } = target;
      target.value = Math.min(Math.max(Number(value) + steps[key], min), max);
      target.dispatchEvent(new Event('input'));
    } else if (control.dataset.action === 'jog') {
      this.beginJog();
    } else {
      (control.matches('form') ? control.querySelector('[type=submit]') : control).click();
    }
  }

  /** A jog lasts while its button, or Ctrl+Enter on it, is held. */
  #wireJog(button) {
    const end = () => this.endJog();
    button.addEventListener('pointerdown', () => this.beginJog());
    for (const type of ['pointerup', 'pointerleave', 'pointercancel', 'blur', 'keyup']) {
      button.addEventListener(type, end);
    }
    // A long touch opens a menu.
    button.addEventListener('contextmenu', (event) => event.preventDefault());
    // The page receives no event for a key or a button that is released in another window.
    addEventListener('blur', end);
    document.addEventListener('visibilitychange', end);
  }

  async beginJog() {
    if (this.#jogging) return;
    this.#jogging = setInterval(() => this.#socket.request('jog').catch((error) => {
      this.endJog();
      this.#message(error.message, true);
    }), JOG_MS);
    if (!(await this.act('jog'))) this.endJog();
  }

  endJog() {
    clearInterval(this.#jogging);
    this.#jogging = undefined;
  }
}
