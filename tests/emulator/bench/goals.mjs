// Goals of the firmware. The bench fails when an enforced goal is missed. Set `enforced` once a goal is reached.

/** Static RAM and the deepest stack together, of 270,336 bytes. */
export const RAM_BYTES = { max: 110_000, enforced: false };

/** The firmware in the flash, bytes, with the host link and its USB stack. */
export const FLASH_BYTES = { max: 250_000, enforced: false };

/** A tick of six axes, all index sensors at one crank angle, corrections in motion; cycles. */
export const WORST_TICK_CYCLES = { max: 8000, enforced: false };
export const MEAN_TICK_CYCLES = { max: 4500, enforced: false };

/** Deadlines missed at any tick rate that the board accepts. */
export const MISSED_DEADLINES = { max: 0, enforced: true };

/** Increase of the worst tick under a saturated host link, cycles. */
export const LINK_TICK_CYCLES = { max: 100, enforced: true };

/** Witnesses of single faults in a tick, cycles. */
export const WITNESS_CYCLES = { max: 150, enforced: true };
