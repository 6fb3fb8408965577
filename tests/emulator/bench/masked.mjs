// Measures how long the firmware blocks interrupts. A tick of the loop may begin later by that time.

/** Watches PRIMASK of the board's processor from now on. Gives { longest: cycles for which it was set without a break }. */
export function watchMasked(board) {
  const watched = { longest: 0 };
  let isMasked = board.core.PM;
  let since = board.cycle;
  Object.defineProperty(board.core, 'PM', {
    get: () => isMasked,
    set: (value) => {
      if (value && !isMasked) since = board.cycle;
      if (!value && isMasked) watched.longest = Math.max(watched.longest, board.cycle - since);
      isMasked = value;
    },
  });
  return watched;
}
