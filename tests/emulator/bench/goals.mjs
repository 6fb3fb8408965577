// Goals of the firmware, and the switch that makes the bench fail when one is missed.

/** Set this to true once the goals are reached: from then on a missed goal is a failure. */
export const ENFORCED = false;

/** Static RAM and the deepest stack together, bytes. */
export const RAM_BYTES = 140_000;

/** The firmware in the flash, bytes. */
export const FLASH_BYTES = 220_000;

/** A tick of six axes, all index sensors at one crank angle, corrections in motion; cycles. */
export const WORST_TICK_CYCLES = 9000;
export const MEAN_TICK_CYCLES = 5000;

/** Ticks a second of six axes. */
export const TICK_HZ = 10_000;

/** Deadlines missed at any tick rate that the board accepts. */
export const MISSED_DEADLINES = 0;
