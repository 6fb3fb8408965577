// Faults that can be injected into a simulated machine: those of `[[fault]]` in a scene, each with the number that it takes, if any.

const KINDS = [
  { kind: 'slip', text: 'crank slips on its shaft', axis: true, key: 'rate_deg_per_s', unit: '°/s', value: 20, lasts: 1 },
  { kind: 'lost-steps', text: 'stepper loses electrical cycles', axis: true, key: 'cycles', unit: 'cycles', value: 1 },
  { kind: 'stuck', text: 'crank stands', axis: true, lasts: 0.5 },
  { kind: 'runaway', text: 'drive turns at a speed of its own', axis: true, key: 'speed_hz', unit: 'rev/s', value: 15, lasts: 0.5 },
  { kind: 'index-missing', text: 'index pulses stay away', axis: true, key: 'count', unit: 'pulses', value: 3 },
  { kind: 'index-extra', text: 'pulses where no flag is', axis: true, key: 'count', unit: 'pulses', value: 1 },
  { kind: 'encoder-glitch', text: 'encoder reading is off', axis: true, key: 'counts', unit: 'counts', value: 500, lasts: 0.1 },
  { kind: 'drive-alarm', text: 'alarm of a drive', axis: true, lasts: 0.5 },
  { kind: 'load-step', text: 'more load on a crank', axis: true, key: 'torque_nm', unit: 'N·m', value: 20, lasts: 1 },
  { kind: 'step-fifo-underrun', text: 'step hardware underruns', axis: true },
  { kind: 'enable-loss', text: 'enable input opens', lasts: 0.5 },
  { kind: 'stop-input', text: 'stop input is active', lasts: 0.5 },
];

/** Wires the form; `inject` takes the keys of a fault. */
export function wireFaults(form, axes, inject) {
  const { kind, axis, value, lasts } = form.elements;
  kind.replaceChildren(...KINDS.map((fault, i) => new Option(`${fault.kind}: ${fault.text}`, String(i))));
  axis.replaceChildren(...Array.from({ length: axes }, (_, i) => new Option(`axis ${i}`, String(i))));
  axis.selectedIndex = Math.min(1, axes - 1);
  const show = () => {
    const fault = KINDS[kind.value];
    axis.closest('label').hidden = !fault.axis;
    value.closest('label').hidden = fault.key === undefined;
    lasts.closest('label').hidden = fault.lasts === undefined;
    form.querySelector('#fault-unit').textContent = fault.unit ?? '';
    value.value = fault.value ?? '';
    lasts.value = fault.lasts ?? '';
  };
  kind.addEventListener('change', show);
  show();
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    const fault = KINDS[kind.value];
    const keys = { kind: fault.kind };
    if (fault.axis) keys.axis = Number(axis.value);
    if (fault.key) keys[fault.key] = Number(value.value);
    if (fault.lasts !== undefined) keys.for_s = Number(lasts.value);
    inject(keys);
  });
}
