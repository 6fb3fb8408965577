// Keys. The help shows the same table.

/**
 * @param {Array<{ key: string, text: string, down: (event: KeyboardEvent) => void, up?: () => void }>} keys `key` is that of a
 *   KeyboardEvent.
 */
export function wireKeys(keys) {
  const isText = (target) => target.closest('textarea, input:not([type=range], [type=checkbox], [type=radio]), [contenteditable]') !== null;
  const isTyping = (target) => isText(target) || target.closest('select') !== null;
  // Space stops the machine, even if a button or a list has the focus. It does not press the button. In a text it is a space.
  const takes = (event) => (event.key === ' ' ? !isText(event.target) : !isTyping(event.target));
  // A key that is released together with Shift has another name.
  const named = (event) => keys.find(({ key }) => key === event.key || key === event.key.toLowerCase());
  const releaseAll = () => keys.forEach((key) => key.up?.());
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !takes(event)) return;
    const found = keys.find(({ key }) => key === event.key);
    if (!found) return;
    // A slider has its own arrows.
    if (event.key.startsWith('Arrow') && event.target.matches('input')) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat || found.repeats) found.down(event);
  }, true);
  addEventListener('keyup', (event) => {
    if (event.key === ' ' && takes(event)) event.preventDefault();
    named(event)?.up?.();
  }, true);
  // The page receives no event for a key that is released in another window.
  addEventListener('blur', releaseAll);
  document.addEventListener('visibilitychange', releaseAll);
}

/** Lists the keys in a table's body. */
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
