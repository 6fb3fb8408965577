//! Followers: how an axis follows the master.
//!
//! A follower converts turns of the master to turns of its axis, tick by tick, without drift. It also bounds the motion of the axis,
//! for the checks at set-up, and gives its acceleration, for the feed-forward of servos.

use core::hash::Hasher;

use super::bounds::Bounds;
use super::cams::Cams;
use crate::units::Turns;

/// Interface of a follower to the controller. Two followers that compare equal make equal motions from then on.
pub trait Follower: Clone + PartialEq {
    /// Turns of the axis for turns of the master in one tick, which must be within ±1 turn. The sum over any ticks has the error of one
    /// tick, less than one unit of the last place for a gear.
    fn advance(&mut self, master: Turns, cams: &Cams) -> Turns;

    /// Acceleration of the axis, turns a tick², at the end of the tick that was advanced last. `speed` (turns a tick) and `acceleration`
    /// (turns a tick²) are those of the master.
    fn acceleration(&self, speed: Turns, acceleration: Turns, cams: &Cams) -> Turns;

    /// Hashes what never changes.
    fn hash_constants(&self, hasher: &mut impl Hasher);

    /// True if the axis makes the master's own turns. Such a follower is never advanced.
    fn is_direct(&self) -> bool;

    /// Position of the axis at the master's phase 0, turns.
    fn start(&self) -> Turns;

    /// Upper bounds on the motion of the axis under bounds on that of the master.
    fn bounds(&self, master: &Bounds, cams: &Cams) -> Bounds;

    /// True if an index flag can show where the axis is: the axis passes it once in each of its turns, always in the master's sense.
    fn allows_index(&self, cams: &Cams) -> bool;
}
