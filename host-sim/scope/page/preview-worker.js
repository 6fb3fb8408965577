// Computes previews in a worker, so that typing never waits. The first message is the compiled module, answered by `{ schema }`. Each
// further one is `{ text, buckets, ticks }`, answered by any number of `{ progress }` and one `{ result }` or `{ failed }`.

import { instantiate } from './preview.js';

let preview;

self.onmessage = async ({ data }) => {
  try {
    if (preview === undefined) {
      preview = instantiate(data, (progress) => self.postMessage({ progress }, [progress.rows.buffer]));
      self.postMessage({ schema: (await preview).schema() });
      return;
    }
    const result = (await preview)(data.text, data);
    self.postMessage({ result }, [result.rows.buffer]);
  } catch (error) {
    self.postMessage({ failed: String(error) });
  }
};
