// The firmware's log as text: its raw bytes decoded by defmt's own decoder.

import { spawnSync } from 'node:child_process';
import { FIRMWARE, INSPECT } from './paths.mjs';

/** Lines of the log so far, oldest first. */
export function log(board) {
  const done = spawnSync(INSPECT, ['log', FIRMWARE, '-'], {
    input: Buffer.from(board.rtt.bytes),
    encoding: 'utf8',
    maxBuffer: 1 << 24,
  });
  if (done.error) throw done.error;
  if (done.status !== 0) throw new Error(`image-inspect log ended with ${done.status}:\n${done.stderr}`);
  return done.stdout.split('\n').filter((line) => line.trim() !== '');
}
