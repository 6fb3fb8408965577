// Sweeps: the mishaps of scenarios/safety.mjs, and others, at many moments instead of one.
//
// What can go wrong between loop, interrupts, DMA and machines depends on the moment. So each mishap is tried at moments
// spread over a tick, from one and the same state of the machine; bench/sweep.mjs says how to have more of them, and how to run
// one alone.

import { blobOf, predict, scene } from '../bench/host.mjs';
import { Machine } from '../bench/machine.mjs';
import { wanted } from '../bench/sweep.mjs';
import { Snapshot } from '../board/snapshot.mjs';
import { Follow } from '../sweeps/follow.mjs';
import { freezes } from '../sweeps/freezes.mjs';

export const title = 'Sweeps: mishaps at every moment';

export function run(outcome) {
  if (wanted('freezes')) freezes(outcome, running(0.09));
}

/** The scene `sweep`, `seconds` after its start, at a deadline. */
function running(seconds) {
  const played = scene('sweep');
  const predicted = predict(played);
  const machine = new Machine({ ...played, blob: blobOf(played) });
  machine.boot();
  const began = machine.start();
  const deadline = began + Math.round(seconds * played.tickHz) * machine.tick;
  machine.board.run({ untilCycle: deadline - machine.tick / 8 });
  const follow = new Follow(machine, predicted, began);
  const perTurn = Array.from({ length: played.axes }, (_, axis) => {
    const own = played.toml.axis.find(({ number }) => number === axis) ?? {};
    const [over, under] = own.ratio ?? [1, 1];
    return ((own.steps_per_turn ?? played.toml.axes.steps_per_turn) * over) / under;
  });
  const reversed = perTurn.map((_, axis) => Number(played.toml.axis.some((own) => own.number === axis && own.reversed)));
  return { machine, follow, began, deadline, perTurn, reversed, snapshot: new Snapshot(machine.board) };
}
