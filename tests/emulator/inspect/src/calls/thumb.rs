//! The instructions of a Cortex-M0+ (Armv6-M: Thumb of 16 bits, and a few of 32), as far as the call graph
//! and the depth of the stack need them.
//!
//! Source: Armv6-M Architecture Reference Manual (Arm DDI 0419E), A5 and A6.

/// Control flow after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// To the next one.
    Next,
    /// To a function, and back.
    Call(u32),
    /// To the function that a register holds, and back.
    CallRegister(u8),
    /// To an address.
    Jump(u32),
    /// To an address, or to the next one.
    JumpIf(u32),
    /// To the address that a register holds: a tail call.
    JumpRegister(u8),
    /// To one of several addresses that a table holds.
    Table,
    /// Back to the caller.
    Return,
    /// Nowhere: undefined on purpose.
    Trap,
}

/// Effect of an instruction on the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stack {
    /// Nothing.
    Stays,
    /// Takes (positive) or gives back bytes.
    Takes(i32),
    /// Adds a register, most often a negative number.
    AddsRegister(u8),
    /// Becomes the content of a register.
    Becomes(u8),
}

/// One instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// 2 or 4 bytes.
    pub length: u32,
    /// Control flow after it.
    pub flow: Flow,
    /// Its effect on the stack.
    pub stack: Stack,
    /// Registers that may change, a bit each; too many rather than too few.
    pub written: u16,
    /// Loads the word at an address into a register.
    pub literal: Option<(u8, u32)>,
    /// True if it takes an address near it, as for the reading of a table.
    pub takes_address: bool,
}

/// Registers that a call may change: r0 to r3, r12 and lr.
const CALLER_SAVED: u16 = 0b0101_0000_0000_1111;

/// The instruction at `address` whose first halfword is `first`; `second` is the halfword after it.
pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    let mut instruction = Instruction {
        length: 2,
        flow: Flow::Next,
        stack: Stack::Stays,
        written: 0,
        literal: None,
        takes_address: false,
    };
    let pc = address.wrapping_add(4);
    let bits = |low: u32, count: u32| first >> low & ((1 << count) - 1);
    let low = 1 << bits(0, 3);
    let high = 1 << bits(8, 3);
    match first >> 11 {
        0b00000..=0b00011 | 0b01010..=0b10001 => instruction.written = low,
        0b00100..=0b00111 | 0b10010 | 0b10011 => instruction.written = high,
        0b01000 if bits(10, 1) == 0 => instruction.written = low,
        0b01000 => special(&mut instruction, first),
        0b01001 => {
            let word = (pc & !3).wrapping_add(u32::from(bits(0, 8)) * 4);
            instruction.literal = Some((bits(8, 3) as u8, word));
            instruction.written = high;
        }
        0b10100 => {
            instruction.takes_address = true;
            instruction.written = high;
        }
        0b10101 => instruction.written = high,
        0b10110 | 0b10111 => miscellaneous(&mut instruction, first),
        0b11000 | 0b11001 => instruction.written = high | bits(0, 8),
        0b11010 | 0b11011 => {
            let offset = i32::from(bits(0, 8) as u8 as i8) * 2;
            instruction.flow = match bits(8, 4) {
                0b1110 => Flow::Trap,
                0b1111 => Flow::Next, // a call of a supervisor: an exception
                _ => Flow::JumpIf(pc.wrapping_add_signed(offset)),
            };
        }
        0b11100 => {
            let offset = (i32::from(bits(0, 11)) << 21) >> 20;
            instruction.flow = Flow::Jump(pc.wrapping_add_signed(offset));
        }
        _ => long(&mut instruction, pc, first, second),
    }
    instruction
}

/// Instructions with high registers: add, compare, move, and jumps to registers.
fn special(instruction: &mut Instruction, bits: u16) {
    let target = (bits >> 4 & 8 | bits & 7) as u8;
    let source = (bits >> 3 & 15) as u8;
    let (is_add, is_move) = (bits >> 8 & 3 == 0, bits >> 8 & 3 == 2);
    if bits >> 8 & 3 == 3 {
        (instruction.flow, instruction.written) = match (bits >> 7 & 1, source) {
            (1, _) => (Flow::CallRegister(source), CALLER_SAVED),
            (_, 14) => (Flow::Return, 0),
            _ => (Flow::JumpRegister(source), 0),
        };
    } else if is_add || is_move {
        instruction.written = 1 << target;
        instruction.takes_address = is_add && source == 15;
        match target {
            13 if is_add => instruction.stack = Stack::AddsRegister(source),
            13 => instruction.stack = Stack::Becomes(source),
            15 if is_move && source == 14 => instruction.flow = Flow::Return,
            15 => instruction.flow = Flow::Table,
            _ => {}
        }
    }
}

/// Instructions for the stack, and small ones.
fn miscellaneous(instruction: &mut Instruction, bits: u16) {
    let bytes = i32::from(bits & 0x7f) * 4;
    let registers = |count: u32| 4 * count as i32;
    match bits >> 8 & 15 {
        0b0000 if bits & 0x80 == 0 => instruction.stack = Stack::Takes(-bytes),
        0b0000 => instruction.stack = Stack::Takes(bytes),
        0b0100 | 0b0101 => {
            instruction.stack = Stack::Takes(registers((bits & 0x1ff).count_ones()));
        }
        0b1100 | 0b1101 => {
            instruction.stack = Stack::Takes(-registers((bits & 0x1ff).count_ones()));
            instruction.written = bits & 0xff;
            if bits & 0x100 != 0 {
                instruction.flow = Flow::Return;
            }
        }
        0b0010 | 0b1010 => instruction.written = 1 << (bits & 7),
        _ => {}
    }
}

/// Instructions of 32 bits: the call, and those for the system's registers.
fn long(instruction: &mut Instruction, pc: u32, first: u16, second: u16) {
    instruction.length = 4;
    if first >> 11 != 0b11110 {
        return;
    }
    if second & 0xd000 == 0xd000 {
        let sign = u32::from(first >> 10 & 1);
        let top = |bit: u32| !(u32::from(second) >> bit & 1 ^ sign) & 1;
        let offset = (sign << 24 | top(13) << 23 | top(11) << 22) as i32
            | i32::from(first & 0x3ff) << 12
            | i32::from(second & 0x7ff) << 1;
        let offset = (offset << 7) >> 7;
        instruction.flow = Flow::Call(pc.wrapping_add_signed(offset));
        instruction.written = CALLER_SAVED;
    } else if first & 0xfff0 == 0xf7f0 && second & 0xf000 == 0xa000 {
        instruction.flow = Flow::Trap;
    } else if first & 0xffe0 == 0xf3e0 {
        instruction.written = 1 << (second >> 8 & 15); // reads a register of the system
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_1000(first: u16, second: u16) -> Instruction {
        decode(0x1000, first, second)
    }

    /// Encodings of an assembler (clang --target=thumbv6m-none-eabi), at address 0x1000.
    #[test]
    fn jumps_and_calls_decode_to_their_targets() {
        for (first, second, expected) in [
            (0xf000, 0xf800, Flow::Call(0x1004)),
            (0xf7ff, 0xfffe, Flow::Call(0x1000)),
            (0xf000, 0xf87e, Flow::Call(0x1100)),
            (0xf3ff, 0xd7ff, Flow::Call(0x0100_1002)), // the furthest forward
            (0xf400, 0xd000, Flow::Call(0xff00_1004)), // the furthest back
            (0xe7fe, 0, Flow::Jump(0x1000)),
            (0xe3ff, 0, Flow::Jump(0x1802)),
            (0xd0fe, 0, Flow::JumpIf(0x1000)),
            (0xd17f, 0, Flow::JumpIf(0x1102)),
            (0xde00, 0, Flow::Trap),
            (0xf7f0, 0xa000, Flow::Trap),
            (0xdf00, 0, Flow::Next),
            (0x4770, 0, Flow::Return),
            (0xbd10, 0, Flow::Return),
            (0xbc10, 0, Flow::Next),
            (0x46f7, 0, Flow::Return),
            (0x4718, 0, Flow::JumpRegister(3)),
            (0x47a0, 0, Flow::CallRegister(4)),
            (0x4487, 0, Flow::Table), // add pc, r0
            (0x4697, 0, Flow::Table), // mov pc, r2
            (0xbf00, 0, Flow::Next),
            (0xf3bf, 0x8f5f, Flow::Next), // dmb
        ] {
            assert_eq!(
                at_1000(first, second).flow,
                expected,
                "{first:04x} {second:04x}"
            );
        }
        assert_eq!(at_1000(0xf3bf, 0x8f5f).length, 4);
        assert_eq!(at_1000(0xe7fe, 0).length, 2);
    }

    #[test]
    fn the_stack_is_counted_in_bytes() {
        for (first, expected) in [
            (0xb5f0, Stack::Takes(20)), // push {r4-r7, lr}
            (0xbdf0, Stack::Takes(-20)),
            (0xb082, Stack::Takes(8)), // sub sp, #8
            (0xb07f, Stack::Takes(-508)),
            (0x44b5, Stack::AddsRegister(6)), // add sp, r6
            (0x46b5, Stack::Becomes(6)),      // mov sp, r6
            (0xaf03, Stack::Stays),           // add r7, sp, #12
            (0x466b, Stack::Stays),           // mov r3, sp
        ] {
            assert_eq!(at_1000(first, 0).stack, expected, "{first:04x}");
        }
    }

    #[test]
    fn literals_are_words_after_the_aligned_program_counter() {
        assert_eq!(decode(0x1000, 0x4b02, 0).literal, Some((3, 0x100c)));
        assert_eq!(decode(0x1002, 0x4b02, 0).literal, Some((3, 0x100c)));
        assert_eq!(at_1000(0x4b02, 0).written, 1 << 3);
    }

    #[test]
    fn registers_that_change_are_reported() {
        for (first, register) in [
            (0x2001, 0), // movs r0, #1
            (0x1c4d, 5), // adds r5, r1, #1
            (0x4153, 3), // adcs r3, r2
            (0x680c, 4), // ldr r4, [r1]
            (0x9c01, 4), // ldr r4, [sp, #4]
            (0xbc20, 5), // pop {r5}
            (0xc960, 6), // ldm r1, {r5, r6}
            (0xb2d1, 1), // uxtb r1, r2
            (0xba0a, 2), // rev r2, r1
            (0x4698, 8), // mov r8, r3
            (0x4798, 3), // blx r3: a call changes r0 to r3
        ] {
            assert_ne!(at_1000(first, 0).written & 1 << register, 0, "{first:04x}");
        }
    }
}
