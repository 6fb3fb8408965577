// Previews every scene of a folder with the WebAssembly module. Every tick has its own row.
//
//     node preview.mjs PROGRAM.wasm FOLDER
//
// For each NAME.toml it writes NAME.json, the answer, and NAME.rows, the rows as 64-bit floats of this machine's byte order.

import fs from 'node:fs';
import path from 'node:path';
import { instantiate } from '../../page/preview.js';

const [program, folder] = process.argv.slice(2);
const module = await WebAssembly.compile(fs.readFileSync(program));
for (const file of fs.readdirSync(folder).filter((file) => file.endsWith('.toml'))) {
  const stem = path.join(folder, path.basename(file, '.toml'));
  const preview = await instantiate(module);
  const { answer, rows } = preview(fs.readFileSync(`${stem}.toml`, 'utf8'), { buckets: 10_000_000, ticks: 4_000_000 });
  fs.writeFileSync(`${stem}.json`, JSON.stringify(answer));
  fs.writeFileSync(`${stem}.rows`, new Uint8Array(rows.buffer));
}
