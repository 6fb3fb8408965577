//! Equations of motion of a platform on cranks, by model level.

use cophase_scene::SceneError;
use cophase_scene::file::{self, Fidelity, Rods};

use super::CranksUnderPlatform;
use crate::dynamics::{Body, Dynamics, Elastic, Frame, Layer, Phased, Rigid, RotorParts};

impl CranksUnderPlatform {
    /// Returns the equations of motion on a model level on which torque moves the cranks.
    ///
    /// # Errors
    /// The *elastic* level needs a frame.
    pub(super) fn on_level(
        &self,
        level: Fidelity,
        rotors: RotorParts,
    ) -> Result<Box<dyn Dynamics>, SceneError> {
        let body = self.body(rotors);
        if level == Fidelity::Rigid {
            return Ok(Box::new(Rigid::new(body)));
        }
        let frame = match level {
            Fidelity::Elastic => Some(frame(self.frame.as_ref().ok_or_else(no_frame)?, &body)),
            _ => None,
        };
        Ok(match self.given.rods {
            Rods::QuasiStatic => {
                let phased = Phased::new(body);
                Box::new(match frame {
                    Some(frame) => phased.on(frame),
                    None => phased,
                })
            }
            Rods::Elastic => {
                let elastic = Elastic::new(body, self.given.rod_zeta);
                Box::new(match frame {
                    Some(frame) => elastic.on(frame),
                    None => elastic,
                })
            }
        })
    }

    /// Returns the platform that the cranks carry.
    fn body(&self, rotors: RotorParts) -> Body {
        let (load, mount_radius_m) = (*self.platform.load(), self.platform.mount_radius_m());
        let disc_kgm2 = even_disc_kgm2(load.mass_kg, mount_radius_m);
        Body {
            mechanism: *self.platform.mechanism(),
            load,
            tilt_inertia_kgm2: self.given.tilt_inertia_kgm2.unwrap_or(disc_kgm2),
            rotors_kgm2: rotors.inertia_kgm2,
            mount_radius_m,
            rod_n_per_m: self.given.rod_n_per_um * 1e6,
            friction_nm: rotors.friction_nm,
        }
    }
}

fn no_frame() -> SceneError {
    SceneError::for_key(
        "frame",
        "missing; fidelity = \"elastic\" has the frame move on its suspension, so give frame.mass_kg and \
         frame.suspension_n_per_mm, or let fidelity be \"phased\"",
    )
}

fn frame(given: &file::Frame, body: &Body) -> Frame {
    let radius_m = body.mount_radius_m;
    let masses = |mass_kg: f64, tilt_inertia_kgm2: Option<f64>| {
        let tilt = tilt_inertia_kgm2.unwrap_or_else(|| even_disc_kgm2(mass_kg, radius_m));
        [mass_kg, tilt, tilt]
    };
    let load = body.masses();
    let own = masses(given.mass_kg, given.tilt_inertia_kgm2);
    Frame {
        suspended: Layer::new(
            own,
            load,
            given.suspension_n_per_mm * 1e3,
            radius_m,
            given.suspension_zeta,
        ),
        foundation: given.foundation.as_ref().map(|foundation| {
            Layer::new(
                masses(foundation.mass_kg, foundation.tilt_inertia_kgm2),
                std::array::from_fn(|f| own[f] + load[f]),
                foundation.ground_n_per_mm * 1e3,
                radius_m,
                foundation.ground_zeta,
            )
        }),
    }
}

/// Inertia of a uniform disc about a diameter, kg·m².
fn even_disc_kgm2(mass_kg: f64, radius_m: f64) -> f64 {
    mass_kg * radius_m * radius_m / 4.0
}
