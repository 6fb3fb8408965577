// DMA in cycles. rp2040js moves any number of words in no time and needs no bus; here each transfer has its cycle.
//
// Convention: the first transfer after a request (a DREQ that rises, a trigger) lands LATENCY cycles after it; while
// the request lasts, one follows each cycle; all channels together make at most one transfer a cycle. The datasheet
// gives the throughput (2.5.1) but not the latency. The latency is an assumption, and much shorter than the time for
// which the eight words of a joined FIFO last.
//
// Also corrected: CHAN_ABORT reads 0 (rp2040js: all ones, so that a read-modify-write aborts every channel); a trigger
// with a count of zero leaves no channel busy. Pacing timers and the sniffer are not modelled, and refused.

import { Fault } from './core-memory.mjs';

export const LATENCY_CYCLES = 4;
const CHAN_ABORT = 0x444;
const SNIFF_CTRL = 0x434;
const TIMERS = [0x420, 0x42c];
const PERMANENT = 63;
const BUSY = 1 << 24;

/** A bus error of a channel is a mistake of the firmware, not a fault of the instruction under way. */
function moveOrExplain(move, index) {
  try {
    move();
  } catch (error) {
    if (error instanceof Fault) throw new Error(`DMA channel ${index}: ${error.message}`);
    throw error;
  }
}

export function fixDma(rp2040) {
  const { dma, clock } = rp2040;
  /** The first cycle in which no channel moves a word yet. */
  dma.freeSlot = 0;

  for (const channel of dma.channels) {
    const move = channel.transfer;
    const requested = () => channel.treqValue === PERMANENT || dma.dreq[channel.treqValue];
    const schedule = (cycle) => {
      const slot = Math.max(cycle, dma.freeSlot);
      dma.freeSlot = slot + 1;
      channel.transferAlarm.at(slot);
    };
    channel.transferAlarm.cancel();
    channel.transferAlarm = clock.createAlarm(() => {
      if (channel.active && requested()) {
        channel.moving = true;
        moveOrExplain(move, channel.index);
        channel.moving = false;
      }
    });
    const stockStart = channel.start;
    channel.start = () => {
      stockStart.call(channel);
      if (channel.transCount === 0) channel.ctrl &= ~BUSY;
    };
    channel.scheduleTransfer = () => {
      if (channel.transferAlarm.scheduled || !requested()) return;
      schedule(clock.cycle + (channel.moving ? 1 : LATENCY_CYCLES));
    };
  }

  const stockRead = dma.readUint32.bind(dma);
  const stockWrite = dma.writeUint32.bind(dma);
  dma.readUint32 = (offset) => (offset === CHAN_ABORT ? 0 : stockRead(offset));
  dma.writeUint32 = (offset, value) => {
    const refused = offset === SNIFF_CTRL || (offset >= TIMERS[0] && offset <= TIMERS[1]);
    if (refused && value !== 0) throw new Error(`DMA register 0x${offset.toString(16)} is not modelled`);
    stockWrite(offset, value);
  };
}
