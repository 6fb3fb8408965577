// The whole state of an emulated machine, to return to later: many cases start from one moment, without booting for
// each.
//
// The state consists of objects that refer to each other, and of functions that refer to them, so nothing is copied into
// new objects. Taking a snapshot walks all objects from one on and keeps the content of each. Restoring writes it into
// the same objects. Objects that were created later are forgotten with the references to them. State in a function's own
// variables cannot be found, so the board keeps its state in properties.

/** Constants, and properties that hold no state: not walked into. */
const CONSTANT = new Set(['elf', 'logger', 'methods']);

export class Snapshot {
  /** Takes a snapshot of everything that can be reached from `root`. */
  constructor(root) {
    this.objects = [];
    this.buffers = [];
    this.take(root);
  }

  take(root) {
    const visited = new Set();
    const waiting = [root];
    const find = (value) => {
      if (value !== null && typeof value === 'object' && !visited.has(value)) {
        visited.add(value);
        waiting.push(value);
      }
    };
    visited.add(root);
    while (waiting.length > 0) {
      const object = waiting.pop();
      if (ArrayBuffer.isView(object)) {
        find(object.buffer);
      } else if (object instanceof ArrayBuffer) {
        this.buffers.push([new Uint8Array(object), new Uint8Array(object.slice(0))]);
      } else if (object instanceof Map) {
        const entries = [...object];
        this.objects.push(() => refill(object, entries, ([key, value]) => object.set(key, value)));
        entries.flat().forEach(find);
      } else if (object instanceof Set) {
        const values = [...object];
        this.objects.push(() => refill(object, values, (value) => object.add(value)));
        values.forEach(find);
      } else if (Array.isArray(object)) {
        this.takeArray(object);
        if (typeof object[0] !== 'number') object.forEach(find);
      } else {
        this.takeObject(object, find);
      }
    }
  }

  /** Arrays get back their former length and items. */
  takeArray(array) {
    const items = array.slice();
    this.objects.push(() => {
      array.length = items.length;
      for (let i = 0; i < items.length; i += 1) array[i] = items[i];
    });
  }

  takeObject(object, find) {
    const names = [];
    const values = [];
    for (const name of Object.keys(object)) {
      const { writable, value } = Object.getOwnPropertyDescriptor(object, name);
      if (!writable || CONSTANT.has(name)) continue;
      names.push(name);
      values.push(value);
      find(value);
    }
    this.objects.push(() => {
      for (let i = 0; i < names.length; i += 1) object[names[i]] = values[i];
    });
  }

  /** Restores everything. */
  restore() {
    for (const [bytes, kept] of this.buffers) bytes.set(kept);
    for (const back of this.objects) back();
  }
}

function refill(collection, items, put) {
  collection.clear();
  items.forEach(put);
}
