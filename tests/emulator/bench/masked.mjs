// Measures how long the firmware blocks interrupts. A tick of the loop may begin later by that time.

/** Watches PRIMASK of the board's processor from now on. Gives { longest: cycles for which it was set without a break, setter:
 * the address of the instruction that set it then }. */
export function watchMasked(board) {
  const watched = { longest: 0, setter: 0 };
  let isMasked = board.core.PM;
  let since = board.cycle;
  let setter = 0;
  Object.defineProperty(board.core, 'PM', {
    get: () => isMasked,
    set: (value) => {
      if (value && !isMasked) [since, setter] = [board.cycle, board.core.PC];
      if (!value && isMasked && board.cycle - since > watched.longest) Object.assign(watched, { longest: board.cycle - since, setter });
      isMasked = value;
    },
  });
  return watched;
}
