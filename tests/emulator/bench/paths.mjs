// Paths of files that the bench uses.

import { fileURLToPath } from 'node:url';
import path from 'node:path';

export const HERE = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '..');
export const ROOT = path.resolve(HERE, '../..');
export const TARGET = process.env.CARGO_TARGET_DIR ?? path.join(ROOT, 'target');

/** The firmware as it is flashed; another one's ELF file in COPHASE_ELF. */
export const FIRMWARE = process.env.COPHASE_ELF ?? path.join(TARGET, 'thumbv6m-none-eabi/firmware/cophase-firmware');

/** The same firmware, built with the compiler's other form of names (tests/emulator/run). */
export const FIRMWARE_V0_NAMES = path.join(TARGET, 'v0-names/thumbv6m-none-eabi/firmware/cophase-firmware');

/** The command, and the tool that reads firmware and logs. */
export const COPHASE = path.join(TARGET, 'release/cophase');
export const INSPECT = path.join(TARGET, 'debug/firmware-inspect');

export const SCENES = path.join(HERE, 'scenes');
export const BUILT_IN = path.join(ROOT, 'host-sim/scenes');
export const DOCS = path.join(ROOT, 'docs');
