//! Step output: every edge of STEP and DIR, without the CPU.
//!
//! One state machine an axis plays the words that the pulse planner made ([`program`]), and a DMA channel feeds it ([`feed`]). Axes 0 to 2
//! are on the first PIO block, 3 to 5 on the second. The words of a tick fill exactly a tick on every axis, so machines that start together
//! stay together.
//!
//! **Start.** All machines are held until each has words in its FIFO. The first word is a pause up to the deadline at which the tick is to
//! begin. Then all machines are started ([`release`]): those of one block in one cycle, and those of the other block by the CPU's next
//! store. The first pause of the second block is shorter by that delay.
//!
//! **Underrun.** The loop submits a tick's words while the tick before is played. If the loop is late, all machines play the words that
//! they have, which are the same tick on every axis. They stop there together, between two edges. They are held and started again,
//! together, at a later deadline. No submission can be late for some axes and in time for others. [`Steps::submit`] submits the words of
//! all axes or of none. It submits none in the last [`MIN_LEAD_US`] before the deadline, which is more than twice the time that all axes
//! take. A machine may still underrun inside a tick whose words were complete (a channel that stopped, interrupts that were disabled). Its
//! axis is then behind the others. The hardware's own flag shows this, and it is reported as a fault.

mod feed;
mod program;
mod release;

use cophase_core::pulse::Run;
use cophase_core::settings::{ActiveLevel, WiringSettings};
use cophase_core::signals::Output;
use cophase_link::board::{Board as _, Rp2040};
use critical_section::CriticalSection;
use embassy_rp::pac;
use embassy_rp::pac::pio::Pio;
use embassy_rp::pac::pio::vals::SmExecctrlStatusSel;
use embassy_time::{Duration, Instant};
use pio::Wrap;

use super::pins::{self, AXES};
use super::{CYCLES_PER_US, GUARD_MACHINE, INDEX_MACHINE, now_us};

/// The PIO blocks.
const BLOCKS: [Pio; 2] = [pac::PIO0, pac::PIO1];

/// Machines of a block that make steps.
const MACHINES: usize = 3;

/// Time from holding the machines to starting them, µs. Code that may have to come from flash fills their FIFOs in this time.
const HOLD_US: u32 = 50;

/// Latest time before a tick is due at which stopped machines are started, µs.
const MIN_BEGIN_US: u32 = HOLD_US + 20;

/// Time by which words must be submitted before they are due, µs.
const MIN_LEAD_US: u32 = Rp2040::MIN_LEAD_US;

/// The block of an axis, from a table: the board has no instruction that divides.
const fn block_of(axis: usize) -> usize {
    static BLOCK: [u8; AXES] = [0, 0, 0, 1, 1, 1];
    BLOCK[axis] as usize
}

/// Registers of the block of an axis.
const fn block(axis: usize) -> Pio {
    if block_of(axis) == 0 {
        pac::PIO0
    } else {
        pac::PIO1
    }
}

/// The machine of an axis within its block.
const fn machine_of(axis: usize) -> usize {
    static MACHINE: [u8; AXES] = [0, 1, 2, 0, 1, 2];
    MACHINE[axis] as usize
}

/// Machines of a block, a bit each, that make steps on a machine of `axes` axes.
const fn machines(block: usize, axes: usize) -> u8 {
    let used = axes.saturating_sub(block * MACHINES);
    let used = if used > MACHINES { MACHINES } else { used };
    (1 << used) - 1
}

/// Instructions of a block that the program takes, from the first on.
pub const PROGRAM_LENGTH: usize = 15;

/// Result of a submission of words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submission {
    /// The words will be played when they are due, directly after the words before them.
    Taken,
    /// The words will be played when they are due. The machines had stopped, and were started this many cycles before that.
    Begun(u32),
    /// The submission was too late: the machines have stopped, or will stop.
    TooLate,
    /// An axis underran inside a tick: it is behind the others. Nothing was taken.
    Underrun(usize),
}

/// The step output of all axes.
pub struct Steps {
    axes: usize,
    /// Machines of each block that make steps, a bit each.
    machines: [u8; 2],
    tick: Duration,
    /// The deadline up to which the machines have words. None if they have stopped.
    until: Option<Instant>,
}

impl Steps {
    /// Sets up pins, machines and channels of as many axes as there are in `reversed`, on the lines of the board's axes from
    /// `first` on. Nothing moves yet. The [cycle counter](super::systick) must run when the machines are started.
    #[cold]
    pub fn new(reversed: &[bool], first: usize, active: ActiveLevel, tick: Duration) -> Self {
        let axes = reversed.len().min(AXES);
        let program = program::step_program();
        assert!(program.code.len() == PROGRAM_LENGTH);
        for (block, pio) in BLOCKS.iter().enumerate() {
            if machines(block, axes) != 0 {
                for (slot, &instruction) in program.code.iter().enumerate() {
                    let memory = pio.instr_mem(slot);
                    memory.write(|w| w.set_instr_mem(instruction));
                }
            }
        }
        let is_inverted = active != WiringSettings::DEFAULT.step;
        for (axis, &is_reversed) in reversed.iter().enumerate().take(axes) {
            let pins = [
                (pins::STEP[first + axis], is_inverted),
                (pins::DIR[first + axis], is_reversed),
            ];
            set_up_machine(axis, pins, program.wrap);
            feed::set_up(axis);
        }
        feed::listen();
        Self {
            axes,
            machines: [0, 1].map(|block| machines(block, axes)),
            tick,
            until: None,
        }
    }

    /// The length of a tick.
    pub const fn tick(&self) -> Duration {
        self.tick
    }

    /// Submits a tick's runs, to be played from `start` on: those of all axes, or of none.
    ///
    /// # Safety
    /// The channels read the runs of the output until the end of that tick. Until then they must not move, and only the planner's
    /// other buffer may be written.
    pub unsafe fn submit(&mut self, output: &Output, start: Instant) -> Submission {
        let submission = cortex_m::interrupt::free(|_| {
            // SAFETY: only this core runs, and its interrupts are disabled.
            self.hand_over(unsafe { CriticalSection::new() }, output, start)
        });
        if matches!(submission, Submission::Taken | Submission::Begun(_)) {
            self.until = start.checked_add(self.tick);
        }
        submission
    }

    fn hand_over(
        &mut self,
        cs: CriticalSection<'_>,
        output: &Output,
        start: Instant,
    ) -> Submission {
        let lead_us = (start.as_ticks() as u32).wrapping_sub(now_us());
        if (lead_us as i32) < MIN_LEAD_US as i32 {
            return Submission::TooLate;
        }
        if let Some(axis) = feed::take_late() {
            self.until = None;
            return Submission::Underrun(axis);
        }
        feed::publish();
        if self.until == Some(start) {
            if let Some(axis) = self.underrun_axis() {
                self.until = None;
                return Submission::Underrun(axis);
            }
            for (axis, runs) in output.all_runs().take(self.axes).enumerate() {
                feed::feed(cs, axis, runs);
            }
            Submission::Taken
        } else if lead_us >= MIN_BEGIN_US && self.all_stand(cs) {
            Submission::Begun(self.begin(cs, output, start))
        } else {
            Submission::TooLate
        }
    }

    /// Starts all machines so that their first pause ends at `start`. Returns the length of the pause in cycles.
    #[inline(never)] // once a start
    fn begin(&self, cs: CriticalSection<'_>, output: &Output, start: Instant) -> u32 {
        let enabled = |pio: Pio| pio.ctrl().read().sm_enable();
        let [first, second] = self.machines;
        pac::PIO0
            .ctrl()
            .write(|w| w.set_sm_enable(enabled(pac::PIO0) & !first));
        pac::PIO1
            .ctrl()
            .write(|w| w.set_sm_enable(enabled(pac::PIO1) & !second));

        let go_us = now_us().wrapping_add(HOLD_US);
        let pause = (start.as_ticks() as u32).wrapping_sub(go_us) * CYCLES_PER_US;
        for (axis, runs) in output.all_runs().take(self.axes).enumerate() {
            let earlier = release::SKEW * block_of(axis) as u32;
            let forward = runs.first().is_some_and(|first| first.forward());
            let pause = Run::pause(pause - earlier, forward);
            let fifo = block(axis).txf(machine_of(axis));
            fifo.write_value(pause.bits());
            feed::feed(cs, axis, runs);
        }
        let in_time = release::release(
            go_us,
            first | 1 << INDEX_MACHINE,
            second | 1 << GUARD_MACHINE,
        );
        if !in_time {
            // The machines' ticks no longer match the timer, or those of the two blocks differ. The next submission reports it.
            feed::flag_underrun(0);
        }
        for (pio, machines) in BLOCKS.into_iter().zip([first, second]) {
            // Clears the flags of the wait, which is over. The pause is not over, so no machine can have underrun again.
            pio.fdebug().write(|w| w.set_txstall(machines));
        }
        pause
    }

    /// Returns an axis whose machine has waited for words since it was started.
    fn underrun_axis(&self) -> Option<usize> {
        // In most cases none has, which two registers show.
        let stalled = |machines: u8, pio: Pio| pio.fdebug().read().txstall() & machines != 0;
        let [first, second] = self.machines;
        if !stalled(first, pac::PIO0) && !stalled(second, pac::PIO1) {
            return None;
        }
        first_underrun(self.axes)
    }

    /// Returns true if every machine has played all its words and waits for more.
    #[inline(never)] // once a start
    fn all_stand(&self, cs: CriticalSection<'_>) -> bool {
        (0..self.axes.min(AXES)).all(|axis| {
            let pio = block(axis);
            let machine = machine_of(axis);
            let empty = pio.fstat().read().txempty() & 1 << machine != 0;
            empty
                && !feed::is_busy(axis)
                && !feed::is_waiting(cs, axis)
                && pio.sm(machine).addr().read().addr() == 0
        })
    }
}

/// Returns the first of so many axes whose machine has waited for words since it was started.
#[inline(never)] // seldom
fn first_underrun(axes: usize) -> Option<usize> {
    (0..axes.min(AXES)).find(|&axis| has_underrun(axis))
}

/// Returns true if the machine of an axis has waited for words since it was started.
#[inline(always)] // The caller knows that there is such an axis.
fn has_underrun(axis: usize) -> bool {
    block(axis).fdebug().read().txstall() & 1 << machine_of(axis) != 0
}

/// Sets up the state machine of an axis, on its pins for STEP and DIR, each with true if it is inverted. The machine waits at the
/// program's first instruction, which is at address 0.
#[cold]
fn set_up_machine(axis: usize, pins: [(u8, bool); 2], wrap: Wrap) {
    let (block, machine) = (block_of(axis), machine_of(axis));
    let [(step, _), (dir, _)] = pins;
    let sm = BLOCKS[block].sm(machine);
    sm.clkdiv().write(|w| w.set_int(1));
    sm.execctrl().write(|w| {
        w.set_side_en(true);
        w.set_wrap_top(wrap.source);
        w.set_wrap_bottom(wrap.target);
        w.set_status_sel(SmExecctrlStatusSel::TXLEVEL);
    });
    sm.shiftctrl().write(|w| {
        w.set_fjoin_tx(true);
        w.set_out_shiftdir(true); // right: the lowest bits come first
    });
    for (pin, is_inverted) in pins {
        // SET is used only here: the machine drives the pin from here on.
        const SET_PINDIRS_1: u16 = 0xE081;
        sm.pinctrl().write(|w| {
            w.set_set_base(pin);
            w.set_set_count(1);
        });
        sm.instr().write(|w| w.set_instr(SET_PINDIRS_1));
        super::lines::give_to_block(pin, block, is_inverted);
    }
    sm.pinctrl().write(|w| {
        w.set_out_base(step);
        w.set_out_count(1);
        w.set_in_base(step);
        w.set_sideset_base(dir);
        w.set_sideset_count(2); // the bit that enables the side-set, and the pin's
    });
    const JMP_0: u16 = 0;
    sm.instr().write(|w| w.set_instr(JMP_0));
}
