import { blobOf, predict, scene, withAxes } from './bench/host.mjs';
import { Machine, image } from './bench/machine.mjs';
import { act } from './bench/play.mjs';
import { Profile } from './board/usage.mjs';
import * as elfm from './board/elf.mjs';
const axes = Number(process.argv[2] ?? 6);
const played = scene('everything', withAxes(axes));
const predicted = predict(played);
const blob = blobOf(played);
function go(from, to) {
  const machine = new Machine({ ...played, blob, options: { profile: true } });
  machine.boot();
  const began = machine.start();
  if (from) {
    const p = machine.board.profile; p.counts.clear();
    const add = p.add.bind(p);
    p.add = (pc, c) => { const now = machine.board.cycle; if (now >= from && now <= to) add(pc, c); };
  } else machine.board.profile.counts.clear();
  act(machine, played, predicted, began);
  return { machine, began };
}
const first = go();
const ticks = first.machine.ticks(first.began);
console.log('mean', ticks.reduce((s, t) => s + t.own, 0) / ticks.length, 'n', ticks.length);
const functions = first.machine.board.elf?.functions ?? elfm.functions?.(image());
const show = (m, n, per) => { for (const { name, cycles } of m.board.profile.byFunction(functions).slice(0, n)) console.log(String((cycles / per).toFixed(0)).padStart(7), name.slice(0, 110)); };
show(first.machine, 40, ticks.length);
const sorted = [...ticks].sort((a, b) => b.own - a.own);
console.log('worst', sorted.slice(0, 12).map((t) => `${t.own}@${Math.round((t.entry - first.began) / first.machine.tick)}`).join(' '));
const w = sorted[Number(process.argv[3] ?? 0)];
const second = go(w.entry, w.end);
show(second.machine, 45, 1);
