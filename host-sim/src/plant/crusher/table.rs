//! The crusher that the table `[crusher]` of a scene describes.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

use cophase_methods::problems::crusher::{Jaw, Linkage, Load, Shape};

use super::Crusher;
use crate::drives::AtCrank;
use crate::plant::{Made, Table};
use crate::scene::file::{CrusherTable, Rock};
use crate::scene::{Scene, SceneError, in_range};

impl Rock {
    const fn shape(self) -> Shape {
        match self {
            Self::LinearRise => Shape::LinearRise,
            Self::SecondHalf => Shape::SecondHalf,
            Self::Constant => Shape::Constant,
        }
    }
}

impl CrusherTable {
    fn crusher(&self, scene: &Scene) -> Result<Crusher, SceneError> {
        let lengths = [
            ("eccentric_mm", self.eccentric_mm),
            ("jaw_mm", self.jaw_mm),
            ("toggle_mm", self.toggle_mm),
            ("ground_mm", self.ground_mm),
            ("force_mm", self.force_mm),
        ];
        for (key, length_mm) in lengths {
            in_range(&format!("crusher.{key}"), length_mm, 0.1, 20_000.0)?;
        }
        in_range("crusher.jaw_kg", self.jaw_kg, 0.0, 1e6)?;
        in_range(
            "crusher.jaw_centre_mm",
            self.jaw_centre_mm,
            0.0,
            self.jaw_mm,
        )?;
        in_range("crusher.rock_kn", self.rock_kn, 0.0, 1e5)?;
        let (from, to) = self.rock_turns;
        in_range("crusher.rock_turns[0]", from, 0.0, 1e7)?;
        in_range("crusher.rock_turns[1]", to, from, 1e7)?;
        let linkage = Linkage {
            eccentric_m: self.eccentric_mm / 1e3,
            jaw_m: self.jaw_mm / 1e3,
            toggle_m: self.toggle_mm / 1e3,
            ground_m: self.ground_mm / 1e3,
            force_m: self.force_mm / 1e3,
        };
        self.check_turns()?;
        let motor = AtCrank::new(scene, 0);
        Ok(Crusher {
            linkage,
            jaw: Jaw {
                mass_kg: self.jaw_kg,
                centre_m: self.jaw_centre_mm / 1e3,
                inertia_kgm2: self.jaw_kg * linkage.jaw_m * linkage.jaw_m / 12.0,
            },
            load: Load::new(self.rock.shape(), 1e3 * self.rock_kn, &linkage),
            fed_rad: from * TAU..to * TAU,
            flywheel_kgm2: motor.rotor_inertia_kgm2,
            motor_nm: motor
                .induction
                .map(|motor| motor.breakdown_ratio * motor.rated_nm)
                .or(motor.servo.and_then(|servo| servo.limit_nm)),
        })
    }

    /// Checks that the eccentric can turn fully. The eccentric is nearest to the pivot at one end of the turn, and farthest
    /// at the other. At both, jaw and toggle plate must span the distance without being in line.
    fn check_turns(&self) -> Result<(), SceneError> {
        let (nearest, furthest) = (
            (self.ground_mm - self.eccentric_mm).abs(),
            self.ground_mm + self.eccentric_mm,
        );
        let (folded, stretched) = (
            (self.jaw_mm - self.toggle_mm).abs(),
            self.jaw_mm + self.toggle_mm,
        );
        if nearest > folded && furthest < stretched {
            return Ok(());
        }
        Err(SceneError::at(
            "crusher.ground_mm",
            format!(
                "{} puts the eccentric {nearest} to {furthest} mm from the toggle's pivot, and jaw and toggle plate span {folded} to {stretched} mm: the \
                 shaft cannot turn all round; change it, or the lengths of jaw and toggle plate",
                self.ground_mm
            ),
        ))
    }
}

impl Table for CrusherTable {
    fn key(&self) -> &'static str {
        "crusher"
    }

    fn plant_name(&self) -> &'static str {
        super::NAME
    }

    fn axes(&self) -> RangeInclusive<usize> {
        1..=1
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        let crusher = self.crusher(scene)?;
        let radius = ("crusher.eccentric_mm", crusher.amplitude_m());
        Made::square_law(scene, self.key(), radius, Arc::new(crusher))
    }
}
