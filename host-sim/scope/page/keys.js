// Keys. The table is also what the help shows.

/**
 * @param {Array<{ key: string, text: string, down: (event: KeyboardEvent) => void, up?: () => void }>} keys `key` is that of a
 *   KeyboardEvent.
 */
export function wireKeys(keys) {
  const isTyping = (target) => target.closest('textarea, input:not([type=range]), select, [contenteditable]') !== null;
  // Space stops the machine also while a button has the focus, which it would press. In a text it is a space.
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    const found = keys.find(({ key }) => key === event.key);
    if (!found) return;
    // A slider has its own arrows.
    if (event.key.startsWith('Arrow') && event.target.matches('input')) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat || found.repeats) found.down(event);
  }, true);
  addEventListener('keyup', (event) => {
    const found = keys.find(({ key }) => key === event.key);
    if (event.key === ' ' && !isTyping(event.target)) event.preventDefault();
    found?.up?.();
  }, true);
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
