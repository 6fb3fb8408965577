// Runs scenarios; exit status 1 if a check fails.

import { join } from 'node:path';
import { board } from './board.mjs';
import { frames } from './frames.mjs';
import { ROOT, browser, check, failed } from './harness.mjs';
import { screenshots } from './screenshots.mjs';
import { simulated } from './simulated.mjs';

const HELP = `run [SCENARIO]… [--screenshots]

  simulated      edit, load, arm, start, fault, CSV, trigger, keys, sizes, themes, lost contact; against --to sim (default)
  board          edit, load, arm, start, stop; against the firmware in the emulator
  frames         measures frames a second, with six axes at 2 kHz; takes two minutes
  --screenshots  writes the pictures of docs/scope.md

COPHASE is the command to test, else it is built; CHROMIUM the browser, else Debian's.`;

const scenarios = { simulated, board, frames, '--screenshots': screenshots };
const names = process.argv.slice(2);
if (names.includes('--help')) {
  console.log(HELP);
  process.exit(0);
}
const unknown = names.find((name) => !(name in scenarios));
if (unknown) {
  console.error(`run: there is no scenario ${unknown}\n${HELP}`);
  process.exit(2);
}
let chrome;
try {
  chrome = await browser();
  for (const name of names.length > 0 ? names : ['simulated']) {
    console.log(`# ${name.replace('--', '')}`);
    await scenarios[name](chrome);
  }
} catch (error) {
  check('the scenario ends', false, error.stack);
  for (const page of chrome?.contexts().flatMap((context) => context.pages()) ?? []) {
    const path = join(ROOT, 'target/scope-failure.png');
    await page.screenshot({ path });
    console.log(`the page is in ${path}`);
  }
}
await chrome?.close();
console.log(failed() === 0 ? 'all checks passed' : `${failed()} checks failed`);
process.exit(failed() === 0 ? 0 : 1);
