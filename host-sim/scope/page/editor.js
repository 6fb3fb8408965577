// Editor of a scene's program: text with line numbers, keys to choose, and mistakes at their lines, and a plot of the controller's commands.

import { Completion } from './editor-completion.js';
import { insertExample, EXAMPLES } from './editor-examples.js';
import { Plot } from './editor-plot.js';
import { summarise } from './editor-summary.js';
import { TextPane } from './editor-text.js';
import { html } from './html.js';
import { Previews } from './previews.js';

/** Names of the list of mistakes and of the meaning of a key, which describe the text area, and of the list of keys. */
const LIST_ID = 'program-mistakes';
const HINT_ID = 'program-hint';
const CHOICES_ID = 'program-choices';

/**
 * Makes an editor inside `element`. `text` is the initial scene (TOML). `onLoad(text)` loads a text. It may return a sentence to
 * show, or a promise of one. It throws an error with a sentence if the text is refused.
 *
 * Returns `{ text, setText(text), refuse(reason), close() }`. While there is a reason, nothing can be loaded. The element receives
 * the event `preview` when a preview is drawn, with `{ answer, rows, ms }` in its `detail`: `ms` is the time since the text changed.
 */
export function createEditor(element, { text = '', onLoad } = {}) {
  const parts = html(element, 'program-editor', TEMPLATE);
  const pane = new TextPane(parts.text, { describedBy: `${HINT_ID} ${LIST_ID}`, onInput: changed });
  const plot = new Plot(parts.plot);
  parts.hint.id = HINT_ID;
  pane.choices.id = CHOICES_ID;
  const completion = new Completion(pane, pane.choices, parts.hint);
  const previews = new Previews({
    onSchema: (schema) => (completion.schema = schema),
    onProgress: progressed,
    onResult: drawn,
    onFailed: failed,
  });
  let changedAt = 0;
  let limits = null;
  let isLoading = false;
  let isValid = false;
  let refusal;

  for (const { name } of EXAMPLES) parts.example.add(new Option(name));
  parts.insert.addEventListener('click', () => insertExample(pane, parts.example.selectedIndex, limits));
  parts.load.addEventListener('click', load);
  if (!onLoad) parts.load.hidden = true;
  pane.text = text;
  changed();

  function changed() {
    changedAt = performance.now();
    parts.result.textContent = '';
    previews.request(pane.text);
  }

  function progressed({ rows, ticks, expectedTicks }) {
    plot.draw(rows, limits);
    parts.summary.textContent = `Computing: ${Math.min(99, Math.round((100 * ticks) / expectedTicks))} %`;
  }

  function drawn({ answer, rows }) {
    showMistakes(answer.mistakes);
    if (answer.scene) {
      limits = answer.scene.limits;
      plot.draw(rows, limits);
      parts.summary.replaceChildren(...summarise(answer.scene, rows));
    }
    element.dispatchEvent(new CustomEvent('preview', { bubbles: true, detail: { answer, rows, ms: performance.now() - changedAt } }));
  }

  function failed(message) {
    showMistakes([{ line: null, text: `The preview cannot be computed: ${message}. Change the text, or reload the page.` }]);
  }

  function showMistakes(mistakes) {
    isValid = mistakes.length === 0;
    pane.mark(mistakes);
    plot.isOutdated = !isValid;
    parts.mistakes.id = LIST_ID;
    const items = mistakes.map((mistake) => mistakeItem(mistake));
    // A list that stays the same is not announced again.
    const now = items.map((item) => item.textContent).join('\n');
    if (parts.mistakes.dataset.text !== now) {
      parts.mistakes.dataset.text = now;
      parts.mistakes.replaceChildren(...items);
    }
    updateLoad();
  }

  function mistakeItem({ line, text: problem }) {
    const item = document.createElement('li');
    if (line !== null) {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = `Line ${line}`;
      button.addEventListener('click', () => pane.goTo(line));
      item.append(button, ' ');
    }
    item.append(problem);
    return item;
  }

  function updateLoad() {
    parts.load.disabled = !isValid || isLoading || refusal !== undefined;
    parts.load.title = isValid ? (refusal === undefined ? '' : `Not now: ${refusal}`) : 'Fix the mistakes first';
  }

  async function load() {
    isLoading = true;
    updateLoad();
    parts.result.className = '';
    parts.result.textContent = 'Loading…';
    try {
      const sentence = await onLoad(pane.text);
      parts.result.textContent = typeof sentence === 'string' ? sentence : 'Loaded.';
    } catch (error) {
      parts.result.className = 'is-refused';
      parts.result.textContent = `Not loaded: ${error.message ?? error}`;
    }
    isLoading = false;
    updateLoad();
  }

  return {
    get text() {
      return pane.text;
    },
    setText(newText) {
      pane.text = newText;
      changed();
    },
    refuse(reason) {
      if (reason === refusal) return;
      refusal = reason;
      updateLoad();
    },
    close() {
      previews.close();
      element.replaceChildren();
    },
  };
}

const TEMPLATE = `
  <div class="pe-bar">
    <label>Example <select data-part="example"></select></label>
    <button type="button" data-part="insert">Replace program</button>
    <span class="pe-space"></span>
    <span role="status" data-part="result"></span>
    <button type="button" data-part="load">Load</button>
  </div>
  <div class="pe-text" data-part="text"></div>
  <p class="pe-hint" data-part="hint"></p>
  <ul class="pe-mistakes" aria-live="polite" aria-label="Mistakes" data-part="mistakes"></ul>
  <div class="pe-plot" data-part="plot"></div>
  <dl class="pe-summary" aria-label="Summary" data-part="summary"></dl>
`;
