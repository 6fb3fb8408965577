// List of keys that can be written at the caret, and the meaning of the key there.
//
// The list opens while a key is typed, or by Ctrl+Space. Arrow keys choose, Tab writes, and any move of the caret closes it. Escape closes
// it, too; in the live page that key always stops the machine as well, so nothing here needs it.

import { choicesAt, meaningAt } from './editor-keys.js';

/** Most choices that are listed. */
const MAX = 50;

export class Completion {
  #pane;
  #list;
  #hint;
  #schema = null;
  #found = null;
  #chosen = 0;

  /** `list` and `hint` are elements for the choices and the meaning. */
  constructor(pane, list, hint) {
    this.#pane = pane;
    this.#list = list;
    this.#hint = hint;
    const { area } = pane;
    area.setAttribute('aria-autocomplete', 'list');
    area.setAttribute('aria-controls', list.id);
    area.addEventListener('input', ({ inputType }) => {
      // Only typed text opens the list, and not an undo or a paste.
      if (inputType === 'insertText' || (this.isOpen && inputType?.startsWith('delete'))) this.#open(1);
      else this.close();
    });
    area.addEventListener('keydown', (event) => this.#key(event));
    area.addEventListener('blur', () => this.close());
    area.addEventListener('scroll', () => this.isOpen && this.#place());
    document.addEventListener('selectionchange', () => {
      if (document.activeElement !== area) return;
      if (this.isOpen && area.selectionStart !== this.#found.caret) this.close();
      this.#explain();
    });
    // The page may keep Escape to itself.
    addEventListener('keydown', ({ key }) => key === 'Escape' && this.close(), true);
    list.addEventListener('pointerdown', (event) => {
      event.preventDefault(); // the text keeps the focus
      const item = event.target.closest('li');
      if (item) this.#write(Number(item.dataset.index));
    });
  }

  set schema(schema) {
    this.#schema = schema;
    this.#explain();
  }

  get isOpen() {
    return !this.#list.hidden;
  }

  close() {
    this.#list.hidden = true;
    this.#pane.area.removeAttribute('aria-activedescendant');
  }

  /** Opens the list, if the word at the caret has so many letters and can become another. */
  #open(letters) {
    const { area } = this.#pane;
    const caret = area.selectionStart;
    const found = this.#schema && caret === area.selectionEnd ? choicesAt(this.#schema, area.value, caret) : null;
    if (!found || found.word.length < letters || found.choices.length === 0) {
      this.close();
      return;
    }
    this.#found = { ...found, caret };
    const items = found.choices.slice(0, MAX).map(({ text }, index) => {
      const item = document.createElement('li');
      item.role = 'option';
      item.id = `${this.#list.id}-${index}`;
      item.dataset.index = index;
      item.textContent = text;
      return item;
    });
    this.#list.replaceChildren(...items);
    this.#list.hidden = false;
    this.#place();
    this.#choose(0);
  }

  #place() {
    this.#pane.place(this.#list, this.#found.caret - this.#found.word.length);
  }

  #choose(index) {
    const items = [...this.#list.children];
    this.#chosen = (index + items.length) % items.length;
    for (const [i, item] of items.entries()) item.ariaSelected = String(i === this.#chosen);
    items[this.#chosen].scrollIntoView({ block: 'nearest' });
    this.#pane.area.setAttribute('aria-activedescendant', items[this.#chosen].id);
    const { text, about } = this.#found.choices[this.#chosen];
    this.#show(text, about);
  }

  #key(event) {
    if (event.key === ' ' && event.ctrlKey) {
      event.preventDefault();
      this.#open(0);
      return;
    }
    if (!this.isOpen || event.ctrlKey || event.altKey || event.metaKey) return;
    const steps = { ArrowDown: 1, ArrowUp: -1 };
    if (event.key in steps) this.#choose(this.#chosen + steps[event.key]);
    else if (event.key === 'Tab' && !event.shiftKey) this.#write(this.#chosen);
    else return;
    event.preventDefault();
  }

  #write(index) {
    const { word, caret, choices } = this.#found;
    const { text, isKey } = choices[index];
    const rest = this.#pane.text.slice(caret).split('\n', 1)[0];
    const end = isKey && !/^\s*=/.test(rest) ? ' = ' : '';
    this.close();
    this.#pane.write(caret - word.length, caret, `${text}${end}`);
  }

  #explain() {
    if (!this.#schema || this.isOpen) return;
    const { area } = this.#pane;
    const meaning = meaningAt(this.#schema, area.value, area.selectionStart);
    this.#show(meaning?.key, meaning?.about);
  }

  #show(key, about) {
    const name = document.createElement('code');
    name.textContent = key ?? '';
    this.#hint.replaceChildren(name, about ? ` ${about}` : '');
  }
}
