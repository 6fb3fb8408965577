//! One function, read instruction by instruction: its possible callees, and the depth of its stack at
//! each.
//!
//! All of its code counts, whether it can be reached inside of the function or not. Compilers make jumps
//! through a table that stay inside the function. A jump counts as one of these only if the instructions
//! before it take the table's address. The depth of the stack is followed along every path. Where two
//! paths meet, the deeper one counts.

use std::collections::{BTreeMap, BTreeSet};

use super::thumb::{self, Flow, Instruction, Stack};
use crate::firmware::{Firmware, Function};

/// Callee of a function, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Callee {
    /// Another, or itself, by its place in [`Firmware::functions`].
    Function(usize),
    /// Code at an address outside of every function.
    Nowhere(u32),
    /// The content of a register, which is not known.
    Unknown,
    /// No function: an instruction that is undefined on purpose.
    Trap,
}

/// Calls and stack of one function.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Possible callees, and the greatest depth of its own stack then, bytes.
    pub calls: BTreeMap<Callee, u32>,
    /// The greatest depth of its own stack; none if that is not known.
    pub depth: Option<u32>,
}

/// A function that takes more stack than the chip has was misread.
const MAX_DEPTH: u32 = 1 << 20;

/// Before a jump through a table, its address is taken at most so many instructions earlier.
const TABLE_WINDOW: usize = 12;

impl Body {
    /// Reads a function.
    pub fn new(firmware: &Firmware, function: &Function) -> Self {
        let code = Code::read(firmware, function);
        let (depths, depth) = code.depths();
        let mut body = Self {
            calls: BTreeMap::new(),
            depth,
        };
        let deepest = depths.values().copied().max().unwrap_or(0);
        for (&at, place) in &code.places {
            let depth = depths.get(&at).copied().unwrap_or(deepest);
            for callee in code.callees(firmware, at, place) {
                body.add(callee, depth);
            }
        }
        // The function, or any function that gets an address from it, may call a function whose address it
        // holds.
        for callee in code.held(firmware) {
            body.add(callee, deepest);
        }
        body
    }

    fn add(&mut self, callee: Callee, depth: u32) {
        let deepest = self.calls.entry(callee).or_insert(depth);
        *deepest = depth.max(*deepest);
    }
}

/// An instruction with the known state before it.
#[derive(Clone, Copy, Debug)]
struct Place {
    instruction: Instruction,
    /// Content of the register that the instruction uses, if it is a literal.
    operand: Option<u32>,
    /// A table's address was taken shortly before.
    table_near: bool,
    /// The instruction before was a call.
    after_call: bool,
}

struct Code<'a> {
    function: &'a Function,
    places: BTreeMap<u32, Place>,
    /// Words that are data inside of the function, or are loaded as literals.
    words: BTreeSet<u32>,
}

impl<'a> Code<'a> {
    fn read(firmware: &Firmware, function: &'a Function) -> Self {
        let section = &firmware.sections[function.section];
        let mut instructions = BTreeMap::new();
        let mut words = BTreeSet::new();
        let mut at = function.address;
        while at < function.end {
            if !section.is_code(at) {
                words.extend(section.word(at & !3));
                at += 2;
                continue;
            }
            let Some(first) = section.halfword(at) else {
                break;
            };
            let mut instruction = thumb::decode(at, first, section.halfword(at + 2).unwrap_or(0));
            if let Flow::Call(target) = instruction.flow
                && target != function.address
                && (function.address..function.end).contains(&target)
            {
                // No other jump has this range; the address that it leaves in lr is not used.
                instruction.flow = Flow::Jump(target);
            }
            instructions.insert(at, instruction);
            if let Some((_, literal)) = instruction.literal {
                words.extend(section.word(literal));
            }
            at += instruction.length;
        }
        let literal = |address| section.word(address);
        let places = places(&instructions, literal);
        Self {
            function,
            places,
            words,
        }
    }

    fn contains(&self, address: u32) -> bool {
        (self.function.address..self.function.end).contains(&address)
    }

    /// Callees and traps of one instruction.
    fn callees(&self, firmware: &Firmware, at: u32, place: &Place) -> Vec<Callee> {
        let to = |address: u32| {
            firmware
                .function_around(address)
                .map_or(Callee::Nowhere(address), Callee::Function)
        };
        let mut callees = Vec::new();
        match place.instruction.flow {
            Flow::Call(target) => callees.push(to(target)),
            Flow::Jump(target) | Flow::JumpIf(target) if !self.contains(target) => {
                callees.push(to(target));
            }
            Flow::CallRegister(_) | Flow::JumpRegister(_) => {
                callees.push(
                    place
                        .operand
                        .map_or(Callee::Unknown, |to_odd| to(to_odd & !1)),
                );
            }
            Flow::Table if !place.table_near => callees.push(Callee::Unknown),
            // A trap directly after a call does not count: it guards a call that does not return.
            Flow::Trap if !place.after_call => callees.push(Callee::Trap),
            _ => {}
        }
        let next = at + place.instruction.length;
        let goes_on = matches!(
            place.instruction.flow,
            Flow::Next | Flow::JumpIf(_) | Flow::CallRegister(_)
        );
        if goes_on && next >= self.function.end {
            callees.push(to(next)); // the code continues in the next function
        }
        callees
    }

    /// Functions whose addresses are among the data.
    fn held<'b>(&'b self, firmware: &'b Firmware) -> impl Iterator<Item = Callee> + 'b {
        self.words
            .iter()
            .filter(|&&word| word & 1 == 1)
            .filter_map(|&word| firmware.function_at(word & !1).map(Callee::Function))
    }

    /// The depth of the stack before each instruction, and the greatest; none if that is not known.
    fn depths(&self) -> (BTreeMap<u32, u32>, Option<u32>) {
        let mut depths = BTreeMap::new();
        let mut deepest = 0;
        let mut known = true;
        let mut waiting = vec![(self.function.address, 0)];
        loop {
            while let Some((at, depth)) = waiting.pop() {
                let Some(place) = self.places.get(&at) else {
                    continue;
                };
                if depth > MAX_DEPTH {
                    known = false;
                    continue;
                }
                match depths.get(&at) {
                    Some(&before) if before >= depth => continue,
                    _ => depths.insert(at, depth),
                };
                let after = self.after(at, place, depth);
                known &= after.is_some();
                let after = after.unwrap_or(depth);
                deepest = deepest.max(after);
                let next = at + place.instruction.length;
                match place.instruction.flow {
                    Flow::Next | Flow::Call(_) | Flow::CallRegister(_) => {
                        waiting.push((next, after));
                    }
                    Flow::Jump(target) => waiting.push((target, after)),
                    Flow::JumpIf(target) => waiting.extend([(next, after), (target, after)]),
                    Flow::JumpRegister(_) | Flow::Table | Flow::Return | Flow::Trap => {}
                }
            }
            // The remaining code is reached through tables only, at a stack of at most this depth.
            let left = self.places.keys().find(|at| !depths.contains_key(at));
            match left {
                Some(&at) => waiting.push((at, deepest)),
                None => return (depths, known.then_some(deepest)),
            }
        }
    }

    fn after(&self, at: u32, place: &Place, depth: u32) -> Option<u32> {
        let moved = |by: i32| depth.saturating_add_signed(by);
        match place.instruction.stack {
            Stack::Stays => Some(depth),
            Stack::Takes(bytes) => Some(moved(bytes)),
            Stack::AddsRegister(_) => place
                .operand
                .map(|word| moved((word as i32).wrapping_neg())),
            Stack::Becomes(_) => {
                // The stack pointer is known if a frame is given back, that is if registers are restored
                // next. Otherwise it is not.
                let next = self.places.get(&(at + place.instruction.length))?;
                matches!(next.instruction.stack, Stack::Takes(..0)).then_some(depth)
            }
        }
    }
}

/// The instructions with the known state at each of them.
fn places(
    instructions: &BTreeMap<u32, Instruction>,
    literal: impl Fn(u32) -> Option<u32>,
) -> BTreeMap<u32, Place> {
    let targets: BTreeSet<u32> = instructions
        .values()
        .filter_map(|instruction| match instruction.flow {
            Flow::Jump(target) | Flow::JumpIf(target) => Some(target),
            _ => None,
        })
        .collect();
    // The targets of tables are not known here. Then a literal counts only if it is used at once.
    let has_table = instructions.values().any(|i| i.flow == Flow::Table);
    let mut registers: [Option<u32>; 16] = [None; 16];
    let mut table_age = None;
    let mut after_call = false;
    let mut expected = None;
    let mut places = BTreeMap::new();
    for (&at, &instruction) in instructions {
        if targets.contains(&at) || expected != Some(at) {
            registers = [None; 16];
        }
        let used = match (instruction.flow, instruction.stack) {
            (Flow::CallRegister(register) | Flow::JumpRegister(register), _) => Some(register),
            (_, Stack::AddsRegister(register)) => Some(register),
            _ => None,
        };
        places.insert(
            at,
            Place {
                instruction,
                operand: used.and_then(|register| registers[usize::from(register)]),
                table_near: table_age.is_some_and(|age| age <= TABLE_WINDOW),
                after_call,
            },
        );
        for (register, value) in registers.iter_mut().enumerate() {
            if has_table || instruction.written & 1 << register != 0 {
                *value = None;
            }
        }
        if let Some((register, address)) = instruction.literal {
            registers[usize::from(register)] = literal(address);
        }
        table_age = if instruction.takes_address {
            Some(0)
        } else {
            table_age.map(|age| age + 1)
        };
        after_call = matches!(instruction.flow, Flow::Call(_) | Flow::CallRegister(_));
        let ends = matches!(
            instruction.flow,
            Flow::Jump(_) | Flow::JumpRegister(_) | Flow::Table | Flow::Return | Flow::Trap
        );
        expected = (!ends).then_some(at + instruction.length);
    }
    places
}
