//! How much torque does a motor need to keep step?
//!
//! Takes the built-in scene `lost-steps`, in which one of three steppers has a stiff bearing. Scales that motor's torque,
//! runs the scene, and halves the interval between a torque that is too small and one that is enough:
//!
//!     cargo run --release --package host-sim --example weakest_motor

use std::error::Error;

use cophase_core::supervisor::Fault;
use cophase_scene::{SceneError, library};
use host_sim::checked::Checked;
use host_sim::sim::{Moment, Observer, simulate};

/// Observer that keeps the largest tilt of the platform.
#[derive(Default)]
struct MaxTilt {
    mrad: f64,
}

impl Observer for MaxTilt {
    fn tick(&mut self, moment: &Moment<'_>) {
        moment.raise_tilt(&mut self.mrad);
    }
}

/// End of one run.
struct Ended {
    fault: Option<Fault>,
    tilt_mrad: f64,
}

/// Runs the scene with the torque of the stiff axis scaled.
fn run(torque_scale: f64) -> Result<Ended, SceneError> {
    let built_in = library::find("lost-steps").expect("a built-in scene");
    let mut scene = built_in.scene();
    scene.axis[0].pull_out_scale = torque_scale;
    let mut tilt = MaxTilt::default();
    let outcome = simulate(&Checked::new(scene)?, &mut tilt, |_, _| {})?;
    Ok(Ended {
        fault: outcome.fault,
        tilt_mrad: tilt.mrad,
    })
}

/// Finds the least scale without a fault to 0.01, between one that is too small and one that is enough.
fn min_scale(mut too_small: f64, mut enough: f64) -> Result<f64, SceneError> {
    while enough - too_small > 0.01 {
        let between = 0.5 * (too_small + enough);
        let ended = run(between)?;
        match ended.fault {
            Some(fault) => {
                let name = fault.kind.name();
                println!("{between:.3}  {name}, tilt {:.1} mrad", ended.tilt_mrad);
                too_small = between;
            }
            None => {
                println!("{between:.3}  keeps step, tilt {:.1} mrad", ended.tilt_mrad);
                enough = between;
            }
        }
    }
    Ok(enough)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("torque");
    let scale = min_scale(1.0, 2.0)?;
    println!("The motor needs {scale:.2} times its torque.");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, the example finds a torque at which the motor slips, or one that is more than enough.
    #[test]
    fn the_motor_keeps_step_at_the_scale_that_is_found_and_not_below() {
        let scale = min_scale(1.0, 2.0).unwrap();
        assert!(run(scale).unwrap().fault.is_none());
        assert!(run(scale - 0.01).unwrap().fault.is_some());
    }
}
