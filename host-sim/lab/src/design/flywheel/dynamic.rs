//! Dynamic sizing: the periodic regime of the crusher under rock, and the flywheel that keeps its irregularity within a limit.
//!
//! The equation of motion is integrated over whole turns until a turn ends in the state in which it began. There are two results: a
//! converged one, and one by the scheme of the source with a few nodes a turn. The source has lost its linkage, so
//! [`Linkage::SOURCE`](host_sim::machines::crusher::mains::Linkage::SOURCE) is an assumed one.

use host_sim::machines::crusher::mains::OnMains;
use host_sim::machines::crusher::mains::{Diverged, Speeds};

pub use host_sim::machines::crusher::mains::Shape;

use super::{Design, DesignError};
use crate::design::range::{OutOfRange, Range};

/// Rock that the crusher breaks in every turn, and the method that computes the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rock {
    /// Shape of the force over the closing stroke.
    pub shape: Shape,
    /// Peak of the force, kN: above 0, up to 100,000.
    pub peak_kn: f64,
    /// Nodes a turn of the source's scheme: 4 to 10,000.
    pub nodes: u32,
    /// Irregularity that the flywheel must keep, 0.001 to 0.5. `None` if no flywheel is required.
    pub irregularity: Option<f64>,
}

/// Speeds of the shaft in the periodic regime.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamic {
    /// Rock for which the speeds hold.
    pub rock: Rock,
    /// Converged speeds.
    pub converged: Speeds,
    /// Speeds by the scheme of the source. `None` if that scheme brings the shaft to rest.
    pub by_nodes: Option<Speeds>,
    /// Inertia of the flywheel that keeps the required irregularity, kg·m².
    pub required_kgm2: Option<f64>,
}

const PEAK: Range = Range::above_zero("--rock-kn", 1e5, " kN", "the forces of crushers", 1000.0);
const NODES: Range = Range {
    flag: "--nodes",
    low: 4.0,
    closed: true,
    high: 1e4,
    unit: "",
    meaning: "the nodes of a turn",
    usual: 18.0,
};
const IRREGULARITY: Range = Range {
    flag: "--irregularity",
    low: 0.001,
    closed: true,
    high: 0.5,
    unit: "",
    meaning: "the irregularities of crushers",
    usual: 0.08,
};

/// Relative tolerance of the search for the required inertia.
const FOUND: f64 = 1e-9;

/// Speeds of a drive and flywheel under rock.
///
/// # Errors
/// Numbers are out of their ranges, the motor cannot break the rock, or no flywheel keeps the irregularity.
pub fn periodic(design: &Design, rock: &Rock) -> Result<Dynamic, DesignError> {
    let limit = rock.irregularity.map(|limit| (IRREGULARITY, limit));
    let numbers = [(PEAK, rock.peak_kn), (NODES, f64::from(rock.nodes))];
    let wrong = OutOfRange::find_all(numbers.into_iter().chain(limit));
    if !wrong.is_empty() {
        return Err(DesignError::OutOfRange(wrong));
    }
    let crusher = OnMains {
        torque_curve: design.curve.coefficients,
        belt_ratio: design.requirement.belt_ratio,
        flywheel_kgm2: design.rim_kgm2(),
        ..OnMains::SOURCE
    }
    .with_rock(rock.shape, 1e3 * rock.peak_kn);
    let stalls = |_: Diverged| DesignError::Stalls(rock.peak_kn);
    let from = design.rated_rad_s();
    let converged = crusher.periodic(0.0, from).map_err(stalls)?;
    Ok(Dynamic {
        rock: *rock,
        by_nodes: crusher.periodic_by_source(rock.nodes, 0.0, from).ok(),
        required_kgm2: match rock.irregularity {
            Some(limit) => Some(required_kgm2(&crusher, from, limit)?),
            None => None,
        },
        converged,
    })
}

/// Inertia of the flywheel whose periodic regime has a given irregularity, kg·m². More inertia reduces the irregularity.
fn required_kgm2(crusher: &OnMains, from_rad_s: f64, limit: f64) -> Result<f64, DesignError> {
    let is_enough = |flywheel_kgm2: f64| {
        let crusher = OnMains {
            flywheel_kgm2,
            ..*crusher
        };
        let speeds = crusher.periodic(0.0, from_rad_s);
        speeds.is_ok_and(|speeds| speeds.irregularity() <= limit)
    };
    let mut high = crusher.flywheel_kgm2;
    let mut doublings = 0;
    while !is_enough(high) {
        high *= 2.0;
        doublings += 1;
        // A flywheel of more than a thousand times the inertia is impractical.
        if doublings > 10 {
            return Err(DesignError::Irregularity(limit));
        }
    }
    let mut low = 0.0;
    while high - low > FOUND * high {
        let middle = 0.5 * (low + high);
        if is_enough(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(high)
}
