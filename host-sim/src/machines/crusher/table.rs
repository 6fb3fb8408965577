//! The crusher that the table `[crusher]` of a scene describes.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::machines::crusher::mains::{Jaw, Linkage, Load, Shape};
use cophase_scene::file::{CrusherTable, Rock};
use cophase_scene::{Scene, SceneError, in_range};

use super::Crusher;
use crate::drives::AtCrank;
use crate::machines::{Made, Table};

const fn shape(rock: Rock) -> Shape {
    match rock {
        Rock::LinearRise => Shape::LinearRise,
        Rock::SecondHalf => Shape::SecondHalf,
        Rock::Constant => Shape::Constant,
    }
}

fn crusher(table: &CrusherTable, scene: &Scene) -> Result<Crusher, SceneError> {
    in_range(
        "crusher.jaw_centre_mm",
        table.jaw_centre_mm,
        0.0,
        table.jaw_mm,
    )?;
    let (from, to) = table.rock_turns;
    in_range("crusher.rock_turns[1]", to, from, 1e7)?;
    let linkage = Linkage {
        eccentric_m: table.eccentric_mm / 1e3,
        jaw_m: table.jaw_mm / 1e3,
        toggle_m: table.toggle_mm / 1e3,
        ground_m: table.ground_mm / 1e3,
        force_m: table.force_mm / 1e3,
    };
    check_turns(table)?;
    Ok(Crusher {
        linkage,
        jaw: Jaw {
            mass_kg: table.jaw_kg,
            centre_m: table.jaw_centre_mm / 1e3,
            inertia_kgm2: table.jaw_kg * linkage.jaw_m * linkage.jaw_m / 12.0,
        },
        load: Load::new(shape(table.rock), 1e3 * table.rock_kn, &linkage),
        fed_rad: from * TAU..to * TAU,
        flywheel_kgm2: AtCrank::new(scene, 0).rotor_inertia_kgm2,
        motor_nm: AtCrank::motor(scene, 0)
            .map(|motor| motor.max_nm(0.0))
            .filter(|max_nm| max_nm.is_finite()),
    })
}

/// Checks that the eccentric can turn fully. The eccentric is nearest to the pivot at one end of the turn, and farthest
/// at the other. At both, jaw and toggle plate must span the distance without being in line.
fn check_turns(table: &CrusherTable) -> Result<(), SceneError> {
    let (nearest, furthest) = (
        (table.ground_mm - table.eccentric_mm).abs(),
        table.ground_mm + table.eccentric_mm,
    );
    let (folded, stretched) = (
        (table.jaw_mm - table.toggle_mm).abs(),
        table.jaw_mm + table.toggle_mm,
    );
    if nearest > folded && furthest < stretched {
        return Ok(());
    }
    Err(SceneError::for_key(
        "crusher.ground_mm",
        format!(
            "{} puts the eccentric {nearest} to {furthest} mm from the toggle's pivot, and jaw and toggle plate span {folded} to {stretched} mm: the \
             shaft cannot turn all round; change it, or the lengths of jaw and toggle plate",
            table.ground_mm
        ),
    ))
}

impl Table for CrusherTable {
    fn key(&self) -> &'static str {
        "crusher"
    }

    fn machine_name(&self) -> &'static str {
        super::NAME
    }

    fn axes(&self) -> RangeInclusive<usize> {
        1..=1
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        let crusher = crusher(self, scene)?;
        Made::square_law(scene, self.key(), "crusher.eccentric_mm", Arc::new(crusher))
    }
}
