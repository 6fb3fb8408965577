// Thumb code of the bench's boot ROM. These functions must run as code, because an interrupt may come in the
// middle of them.
//
// Each routine is a list of half-words, labels and branches to them. They are our own, and about as fast as the
// chip's.

const BRANCHES = { b: null, beq: 0, bne: 1, bhs: 2 };
const at = (label) => ({ label });
const go = (branch, to) => ({ branch, to });

/** Resolves labels. Branch offsets count from four bytes behind the branch. */
function assemble(lines) {
  const labels = new Map();
  let length = 0;
  for (const line of lines) {
    if (line.label) labels.set(line.label, length);
    else length += 1;
  }
  const code = [];
  for (const line of lines.filter(({ label }) => !label)) {
    if (line.branch) {
      const offset = labels.get(line.to) - code.length - 2;
      const condition = BRANCHES[line.branch];
      code.push(condition === null ? 0xe000 | (offset & 0x7ff) : 0xd000 | (condition << 8) | (offset & 0xff));
    } else {
      code.push(line);
    }
  }
  return code;
}

/** r0 = lookup(r0: table, r1: code): half-word pairs (code, pointer) up to a code of 0; 0 if there is none. */
// prettier-ignore
export const LOOKUP = assemble([
  at('next'),
  0x8802, //               ldrh  r2, [r0]
  0x2a00, //               cmp   r2, #0
  go('beq', 'none'),
  0x428a, //               cmp   r2, r1
  go('beq', 'found'),
  0x3004, //               adds  r0, #4
  go('b', 'next'),
  at('found'),
  0x8840, //               ldrh  r0, [r0, #2]
  0x4770, //               bx    lr
  at('none'),
  0x2000, //               movs  r0, #0
  0x4770, //               bx    lr
]);

/** r0 = memcpy(r0: to, r1: from, r2: bytes): by words where both are aligned, else by bytes from the end. */
// prettier-ignore
export const MEMCPY = assemble([
  0xb571, //               push  {r0, r4-r6, lr}
  0x0003, //               movs  r3, r0
  0x430b, //               orrs  r3, r1
  0x079b, //               lsls  r3, r3, #30
  go('bne', 'bytes'),
  go('b', 'quads?'),
  at('quads'),
  0xc978, //               ldmia r1!, {r3-r6}
  0xc078, //               stmia r0!, {r3-r6}
  0x3a10, //               subs  r2, #16
  at('quads?'),
  0x2a10, //               cmp   r2, #16
  go('bhs', 'quads'),
  go('b', 'words?'),
  at('words'),
  0xc908, //               ldmia r1!, {r3}
  0xc008, //               stmia r0!, {r3}
  0x3a04, //               subs  r2, #4
  at('words?'),
  0x2a04, //               cmp   r2, #4
  go('bhs', 'words'),
  at('bytes'),
  0x2a00, //               cmp   r2, #0
  go('beq', 'done'),
  at('byte'),
  0x3a01, //               subs  r2, #1
  0x5c8b, //               ldrb  r3, [r1, r2]
  0x5483, //               strb  r3, [r0, r2]
  go('bne', 'byte'),
  at('done'),
  0xbd71, //               pop   {r0, r4-r6, pc}
]);

/** r0 = memset(r0: to, r1: value, r2: bytes): by pairs of words where aligned, else by bytes from the end. */
// prettier-ignore
export const MEMSET = assemble([
  0xb501, //               push  {r0, lr}
  0x0783, //               lsls  r3, r0, #30
  go('bne', 'bytes'),
  0xb2c9, //               uxtb  r1, r1
  0x020b, //               lsls  r3, r1, #8
  0x4319, //               orrs  r1, r3
  0x040b, //               lsls  r3, r1, #16
  0x4319, //               orrs  r1, r3
  0x000b, //               movs  r3, r1
  go('b', 'pairs?'),
  at('pairs'),
  0xc00a, //               stmia r0!, {r1, r3}
  0x3a08, //               subs  r2, #8
  at('pairs?'),
  0x2a08, //               cmp   r2, #8
  go('bhs', 'pairs'),
  at('bytes'),
  0x2a00, //               cmp   r2, #0
  go('beq', 'done'),
  at('byte'),
  0x3a01, //               subs  r2, #1
  0x5481, //               strb  r1, [r0, r2]
  go('bne', 'byte'),
  at('done'),
  0xbd01, //               pop   {r0, pc}
]);
