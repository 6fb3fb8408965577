// The controller in WebAssembly: it converts a scene's text to the commands of its controller.
// It runs in a browser's worker and in Node. Its other side is host-sim/scope/wasm/src/exports.rs.

/** Values of a tick, in the order of the rows. A row has the smallest and the largest of each. */
export const CHANNELS = [
  'requested_mps2',
  'commanded_mps2',
  'speed_rad_s',
  'acceleration_rad_s2',
  'is_lagging',
  'is_held_at_band',
  'is_crossing_band',
  'state',
];

/** Names of the states, by their numbers. */
export const STATES = ['idle', 'homing', 'run', 'stop', 'parked', 'fault'];

/** Rows of buckets. */
export class Rows {
  /** Makes rows from their numbers: first and last time (s), then smallest and largest value of each channel. */
  constructor(numbers) {
    this.numbers = numbers;
    this.width = 2 + 2 * CHANNELS.length;
    this.length = numbers.length / this.width;
  }

  first_s(row) {
    return this.numbers[row * this.width];
  }

  last_s(row) {
    return this.numbers[row * this.width + 1];
  }

  low(row, channel) {
    return this.numbers[row * this.width + 2 + 2 * CHANNELS.indexOf(channel)];
  }

  high(row, channel) {
    return this.numbers[row * this.width + 3 + 2 * CHANNELS.indexOf(channel)];
  }
}

/**
 * Makes a function `preview(text, { buckets, ticks })` from the compiled module. It returns `{ answer, rows }`: the answer of
 * host-sim/scope/wasm/src/answer.rs, and the numbers of the rows. During the preview, it calls
 * `onProgress({ rows, ticks, expectedTicks })`. Its member `schema()` returns the JSON Schema of scenes. After an exception the instance is unusable, and a new one must be made.
 */
export async function instantiate(module, onProgress = () => {}) {
  const instance = await WebAssembly.instantiate(module, {
    page: {
      progress: (pointer, count, ticks, expectedTicks) =>
        onProgress({ rows: numbers(pointer, count), ticks, expectedTicks }),
    },
  });
  const wasm = instance.exports;
  // Memory may grow in any call, and then has another buffer. So all numbers are copied.
  const numbers = (pointer, count) => new Float64Array(wasm.memory.buffer, pointer, count * wasm.row_length()).slice();
  const answer = () => {
    const json = new Uint8Array(wasm.memory.buffer, wasm.answer(), wasm.answer_length());
    return JSON.parse(new TextDecoder().decode(json.slice()));
  };
  const preview = (text, { buckets = 1500, ticks = Infinity } = {}) => {
    const bytes = new TextEncoder().encode(text);
    const room = wasm.room(bytes.length);
    new Uint8Array(wasm.memory.buffer, room, bytes.length).set(bytes);
    wasm.preview(buckets, Math.min(ticks, Number.MAX_SAFE_INTEGER));
    return { answer: answer(), rows: numbers(wasm.envelope(), wasm.envelope_rows()) };
  };
  const schema = () => {
    wasm.schema();
    return answer();
  };
  return Object.assign(preview, { schema });
}
