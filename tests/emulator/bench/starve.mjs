// A stopped channel: the step machine of its axis gets no words, and underruns.

const DMA = 0x5000_0000;
const CHANNEL_BYTES = 0x40;
const AL1_CTRL = 0x10;
const DMA_ENABLE = 1;

/** Longer than the words in a FIFO last. */
const STANDS_S = 0.0008;

export function starve(machine, axis) {
  const ctrl = DMA + CHANNEL_BYTES * axis + AL1_CTRL;
  machine.board.poke(ctrl, machine.board.peek(ctrl) & ~DMA_ENABLE);
  machine.run(STANDS_S);
  machine.board.poke(ctrl, machine.board.peek(ctrl) | DMA_ENABLE);
}
