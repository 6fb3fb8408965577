// Text area with line numbers, and mistakes at the ends of their lines.
//
// The text area has a transparent background. Behind it is a copy of its lines, which marks those with mistakes. Both have
// the same font and scroll together.

import { html } from './html.js';

export class TextPane {
  #parts;
  #mistakes = new Map();
  #lines = 0;

  constructor(element, { describedBy, onInput }) {
    this.#parts = html(element, 'pe-pane', TEMPLATE);
    const { area } = this.#parts;
    area.setAttribute('aria-describedby', describedBy);
    area.addEventListener('input', () => {
      this.#show();
      onInput();
    });
    area.addEventListener('scroll', () => this.#scroll());
  }

  get area() {
    return this.#parts.area;
  }

  /** Element for a list over the text. */
  get choices() {
    return this.#parts.choices;
  }

  get text() {
    return this.#parts.area.value;
  }

  set text(text) {
    this.#parts.area.value = text;
    this.#mistakes.clear();
    this.#show();
  }

  /** Replaces the text so that the browser can undo it. */
  replace(text) {
    this.write(0, this.text.length, text);
  }

  /** Replaces a part of the text so that the browser can undo it. */
  write(start, end, text) {
    const { area } = this.#parts;
    area.focus();
    area.setSelectionRange(start, end);
    // Only this command keeps the history of edits.
    if (!document.execCommand('insertText', false, text)) {
      area.setRangeText(text, start, end, 'end');
      area.dispatchEvent(new Event('input'));
    }
  }

  /** Moves an element below a place in the text, or above it where there is more room. */
  place(element, at) {
    const { area, copy } = this.#parts;
    const before = this.text.slice(0, at).split('\n');
    const row = copy.children[before.length - 1];
    const range = document.createRange();
    range.setStart(row.firstChild, 0);
    range.setEnd(row.firstChild, Math.min(before.at(-1).length, row.firstChild.length));
    const { left, top } = copy.getBoundingClientRect();
    const begin = row.getBoundingClientRect();
    const x = (before.at(-1) ? range.getBoundingClientRect().right : begin.left) - left;
    const [above, below] = [begin.top - top, area.clientHeight - (begin.bottom - top)];
    element.style.maxHeight = '';
    const isBelow = below >= Math.min(above, element.offsetHeight);
    element.style.left = `${Math.max(0, Math.min(x, area.clientWidth - element.offsetWidth))}px`;
    element.style.maxHeight = `${Math.max(isBelow ? below : above, 0)}px`;
    element.style.top = isBelow ? `${begin.bottom - top}px` : 'auto';
    element.style.bottom = isBelow ? 'auto' : `${copy.clientHeight - above}px`;
  }

  /** Shows mistakes, each `{ line, text }`, at their lines. */
  mark(mistakes) {
    const located = Map.groupBy(mistakes.filter(({ line }) => line !== null), ({ line }) => line);
    this.#mistakes = new Map([...located].map(([line, all]) => [line, all.map(({ text }) => text).join(' ◂ ')]));
    this.#parts.area.setAttribute('aria-invalid', String(mistakes.length > 0));
    this.#show();
  }

  /** Moves the caret to the beginning of a line. */
  goTo(line) {
    const { area } = this.#parts;
    const before = area.value.split('\n').slice(0, line - 1);
    const start = before.reduce((sum, text) => sum + text.length + 1, 0);
    area.focus();
    area.setSelectionRange(start, start);
    const height = area.scrollHeight / Math.max(1, this.#lines);
    area.scrollTop = Math.max(0, (line - 1) * height - area.clientHeight / 2);
  }

  #show() {
    const lines = this.text.split('\n');
    this.#lines = lines.length;
    const { numbers, copy } = this.#parts;
    const row = (content, number) => {
      const div = document.createElement('div');
      const mistake = this.#mistakes.get(number);
      div.textContent = content;
      if (mistake !== undefined) {
        div.className = 'has-mistake';
        div.dataset.line = number;
      }
      return { div, mistake };
    };
    numbers.replaceChildren(...lines.map((_, i) => row(String(i + 1), i + 1).div));
    copy.replaceChildren(
      ...lines.map((line, i) => {
        const { div, mistake } = row(line || ' ', i + 1);
        if (mistake !== undefined) {
          const note = document.createElement('span');
          note.textContent = `  ◂ ${mistake}`;
          div.append(note);
        }
        return div;
      }),
    );
    this.#scroll();
  }

  #scroll() {
    const { area, numbers, copy } = this.#parts;
    numbers.scrollTop = area.scrollTop;
    copy.scrollTop = area.scrollTop;
    copy.scrollLeft = area.scrollLeft;
  }
}

const TEMPLATE = `
  <div class="pe-numbers" aria-hidden="true" data-part="numbers"></div>
  <div class="pe-stack">
    <div class="pe-copy" aria-hidden="true" data-part="copy"></div>
    <textarea class="pe-area" aria-label="Scene with its program, TOML" spellcheck="false" autocomplete="off"
      autocapitalize="off" wrap="off" data-part="area"></textarea>
    <ul class="pe-choices" role="listbox" aria-label="Keys" hidden data-part="choices"></ul>
  </div>
`;
