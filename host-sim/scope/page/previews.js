// Preview of the latest text, computed in a worker.

import { Rows } from './preview.js';

/** Longest time for which a preview continues while a newer text waits, ms. A shorter one needs no new worker. */
const GRACE_MS = 60;

/** Buckets of a preview, about as many as a plot has pixels. */
const BUCKETS = 1500;

/** Ticks after which a preview ends: under three hours at 2 kHz. */
export const MAX_TICKS = 20_000_000;

/** Previews of texts. Of the waiting texts, only the newest is computed. */
export class Previews {
  /** Calls `onSchema(schema)`, `onProgress({ rows, ticks, expectedTicks })`, `onResult({ answer, rows })` and `onFailed(message)`. */
  constructor({ onSchema, onProgress, onResult, onFailed }) {
    this.handlers = { onSchema, onProgress, onResult, onFailed };
    this.waiting = null;
    this.worker = null;
    this.isBusy = false;
    this.ready = this.compile();
  }

  async compile() {
    const response = await fetch(new URL('program.wasm', import.meta.url));
    if (!response.ok) throw new Error(`program.wasm: ${response.status} ${response.statusText}`);
    this.module = await WebAssembly.compile(await response.arrayBuffer());
  }

  startWorker() {
    this.worker = new Worker(new URL('preview-worker.js', import.meta.url), { type: 'module' });
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.worker.onerror = (event) => this.receive({ failed: event.message ?? 'the worker could not be started' });
    this.worker.postMessage(this.module);
  }

  /** Ends the worker. The next preview starts another one. */
  close() {
    this.worker?.terminate();
    this.worker = null;
    this.isBusy = false;
  }

  /** Computes a text's preview as soon as possible, instead of those of waiting texts. */
  async request(text) {
    this.waiting = text;
    try {
      await this.ready;
    } catch (error) {
      this.handlers.onFailed(String(error));
      return;
    }
    // An earlier request that also waited may have taken the text.
    if (this.waiting === null) return;
    if (!this.isBusy) this.next();
    else this.grace ??= setTimeout(() => this.abandon(), GRACE_MS);
  }

  next() {
    clearTimeout(this.grace);
    this.grace = undefined;
    if (this.waiting === null) return;
    if (!this.worker) this.startWorker();
    this.isBusy = true;
    this.worker.postMessage({ text: this.waiting, buckets: BUCKETS, ticks: MAX_TICKS });
    this.waiting = null;
  }

  abandon() {
    this.close();
    this.next();
  }

  receive({ schema, progress, result, failed }) {
    if (schema) {
      this.handlers.onSchema(schema);
      return;
    }
    if (progress) {
      if (this.waiting === null) this.handlers.onProgress({ ...progress, rows: new Rows(progress.rows) });
      return;
    }
    this.isBusy = false;
    if (failed !== undefined) {
      this.close();
      this.handlers.onFailed(failed);
    } else if (this.waiting === null) {
      this.handlers.onResult({ answer: result.answer, rows: new Rows(result.rows) });
    }
    this.next();
  }
}
