// Keys. One key acts on the machine: it stops. All others change the view. The help shows the same table.

const isText = (target) => target.matches('textarea, [contenteditable]');
const isTyping = (target) => isText(target) || target.matches('select, input:not([type=range])');

/** Returns true for the key that stops the machine, whatever has the focus and is open: Space, or Escape where Space is a character. */
const isStop = ({ key, target }) => key === (isText(target) ? 'Escape' : ' ');

/**
 * @param {() => void} stop Stops the machine.
 * @param {Array<{ key: string, text: string, down: (event: KeyboardEvent) => void, repeats?: boolean }>} keys Keys of the view. `key`
 *   is that of a KeyboardEvent.
 * @param {HTMLDialogElement} dialog Escape closes it. While it is open, the keys of the view have no effect.
 */
export function wireKeys(stop, keys, dialog) {
  addEventListener('keydown', (event) => {
    const act = action(event);
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat || act.repeats) act.down(event);
  }, true);
  // A button is pressed when Space is released.
  addEventListener('keyup', (event) => {
    if (isStop(event)) event.preventDefault();
  }, true);

  function action(event) {
    if (isStop(event)) return { down: stop };
    if (event.key === 'Escape' && dialog.open) return { down: () => dialog.close() };
    // A browser repeats the click of a button while Enter is held.
    if (event.key === 'Enter' && event.repeat && event.target.matches('button')) return { down: () => {} };
    if (dialog.open || event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return undefined;
    // A slider has its own arrows.
    if (event.key.startsWith('Arrow') && event.target.matches('input')) return undefined;
    return keys.find(({ key }) => key === event.key);
  }
}

/** Lists keys, each `{ key, text }`, in a table's body. */
export function listKeys(body, keys) {
  const names = { ' ': 'Space', ArrowLeft: '←', ArrowRight: '→' };
  body.replaceChildren(...keys.map(({ key, text }) => {
    const row = document.createElement('tr');
    const cell = document.createElement('td');
    const cap = document.createElement('kbd');
    cap.textContent = names[key] ?? key;
    cell.append(cap);
    const what = document.createElement('td');
    what.textContent = text;
    row.append(cell, what);
    return row;
  }));
}
