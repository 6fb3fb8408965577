//! The arm that the table `[five_bar]` of a scene describes.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::machines::five_bar::arm::{FiveBarArm, ForceSensor, HybridLaw, Load, Rod, Surface};
use cophase_scene::file::{Assembly, AxisOverrides, CamTable, ContactTable, FiveBarTable, Plane};
use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use cophase_scene::{Scene, SceneError};

use super::Arm;
use super::path::{NoTable, Path};
use crate::drives::AtCrank;
use crate::machines::{Made, Table};
use crate::mechanism::five_bar::{FiveBar, Unreachable};

/// Index among the solutions of the inverse kinematics.
const fn number(mode: Assembly) -> usize {
    match mode {
        Assembly::Left => 0,
        Assembly::Right => 1,
    }
}

/// Sensor of the force, with the source's converter.
fn sensor(contact: &ContactTable) -> ForceSensor {
    ForceSensor {
        full_scale_n: contact.sensor_n,
        ..ForceSensor::SOURCE
    }
}

/// Names of the joints' cam tables.
const JOINTS: [&str; 2] = ["joint-1", "joint-2"];

fn links(table: &FiveBarTable) -> FiveBar {
    FiveBar {
        l1_m: table.links_mm[0] / 1e3,
        l4_m: table.links_mm[2] / 1e3,
    }
}

fn check(table: &FiveBarTable) -> Result<(), SceneError> {
    if table.path_mm.len() < 2 {
        return Err(SceneError::for_key(
            "five_bar.path_mm",
            "has fewer than two points; give the points of the path, such as [[0, 300], [200, 300]]",
        ));
    }
    let Some(contact) = &table.contact else {
        return Ok(());
    };
    let key = |name: &str| format!("five_bar.contact.{name}");
    let sensor = sensor(contact);
    // The law needs a reading above the force to hold it from both sides.
    if contact.force_n > sensor.max_n() - sensor.step_n() {
        return Err(SceneError::for_key(
            key("force_n"),
            format!(
                "{} N is beyond what the force sensor measures, so the law cannot hold it: five_bar.contact.sensor_n = {} N reaches {:.2} N; \
                 lower the force or give a sensor of a wider range",
                contact.force_n,
                contact.sensor_n,
                sensor.max_n()
            ),
        ));
    }
    if table.path_mm.len() > 2 {
        return Err(SceneError::for_key(
            "five_bar.contact",
            "is a plane surface along one line, and five_bar.path_mm has more than two points; give two",
        ));
    }
    Ok(())
}

fn path(table: &FiveBarTable) -> Result<Path, SceneError> {
    let points: Vec<_> = table
        .path_mm
        .iter()
        .map(|mm| mm.map(|mm| mm / 1e3))
        .collect();
    Path::new(&points, table.speed_mm_per_s / 1e3, table.blend_s).map_err(|short| {
        SceneError::for_key(
            "five_bar.path_mm",
            format!(
                "has a line of {:.4} mm, which is too short for blends of {} s at {} mm/s; lengthen it, shorten the blends or lower the speed",
                1e3 * short.length_m,
                table.blend_s,
                table.speed_mm_per_s
            ),
        )
    })
}

fn tables(table: &FiveBarTable, path: &Path) -> Result<([Vec<f64>; 2], f64), SceneError> {
    let [l1, _, l4] = table.links_mm;
    let at = |point: [f64; 2]| format!("({:.1}, {:.1}) mm", 1e3 * point[0], 1e3 * point[1]);
    path.tables(&links(table), number(table.mode), table.margin).map_err(|no| {
        let problem = match no {
            NoTable::Unreachable(point, Unreachable::Beyond(reach)) => format!(
                "passes {}, {:.1} mm from the axis, and links 1 and 4 reach {} mm; move it nearer or lengthen the links",
                at(point),
                1e3 * reach,
                l1 + l4
            ),
            NoTable::Unreachable(point, _) => format!(
                "passes {}, nearer to the axis than links 1 and 4 differ by, {} mm; move it away",
                at(point),
                (l1 - l4).abs()
            ),
            NoTable::Singular(point, sine) => format!(
                "passes {}, where |sin(q1 − q2)| is {sine:.3}, below five_bar.margin = {}: the arm is nearly singular there; move the path or lower the margin",
                at(point),
                table.margin
            ),
        };
        SceneError::for_key("five_bar.path_mm", problem)
    })
}

fn arm(
    table: &FiveBarTable,
    scene: &Scene,
    path: Path,
    (tables, min_sine): ([Vec<f64>; 2], f64),
) -> Arm {
    let [l1, l2, l4] = table.links_mm.map(|mm| mm / 1e3);
    let lengths = [l1, l2, l1, l4];
    let direction = path.direction();
    let normal = [-direction[1], direction[0]];
    let start = path.start_m();
    let middle = path.at(0.25).at_m;
    let below_m = table.balancer_mm.map_or(middle, |mm| mm.map(|mm| mm / 1e3));
    let is_vertical = table.plane == Plane::Vertical;
    let suspension = match table.plane {
        _ if table.lift_n == 0.0 => Load::None,
        Plane::Vertical => Load::Balancer(table.lift_n),
        Plane::Horizontal => Load::Rope {
            lift_n: table.lift_n,
            length_m: table.rope_mm / 1e3,
            below_m,
        },
    };
    let limits_nm = (0..scene.axes.count).filter_map(|i| AtCrank::motor(scene, i)?.limit_nm());
    let limit_nm = limits_nm.reduce(f64::min);
    Arm {
        arm: FiveBarArm {
            rods: [0, 1, 2, 3].map(|i| Rod {
                length_m: lengths[i],
                mass_kg: table.links_kg[i],
            }),
            hand_kg: table.tool_kg,
            gravity_mps2: if is_vertical {
                STANDARD_GRAVITY_MPS2
            } else {
                0.0
            },
            // The axes already have the friction.
            friction_nm: [0.0; 2],
            friction_speed_rad_s: 1.0,
            load: suspension,
            surface: table.contact.map(|contact| Surface {
                normal,
                distance_m: start[0] * normal[0] + start[1] * normal[1],
                stiffness_n_per_m: 1e3 * contact.stiffness_n_per_mm,
                damping_ns_per_m: contact.damping_ns_per_m,
            }),
            torque_nm: [0.0; 2],
        },
        law: table.contact.map(|contact| HybridLaw {
            position_per_s2: contact.position_per_s2,
            velocity_per_s: contact.velocity_per_s,
            force_per_s: contact.force_per_s,
            required_n: contact.force_n,
            limit_nm: limit_nm.unwrap_or(f64::INFINITY),
            sensor: sensor(&contact),
            integral_ns: 0.0,
        }),
        path,
        quarter_rad: tables.map(|turns| turns[turns.len() / 4] * TAU),
        min_sine,
    }
}

impl Table for FiveBarTable {
    fn key(&self) -> &'static str {
        "five_bar"
    }

    fn machine_name(&self) -> &'static str {
        super::NAME
    }

    fn axes(&self) -> RangeInclusive<usize> {
        2..=2
    }

    fn axes_follow_tables(&self) -> bool {
        true
    }

    /// Adds a cam table for each joint. Program entries without a level get the one at which the path has its own speed.
    fn fill(&self, scene: &mut Scene) -> Result<(), SceneError> {
        check(self)?;
        let path = path(self)?;
        let (tables, _) = tables(self, &path)?;
        let is_made = |table: &CamTable| table.segment.is_empty() && table.file.is_none();
        let own = |table: &CamTable| is_made(table) && JOINTS.contains(&table.name.as_str());
        if let Some(i) = scene.cam_table.iter().position(|table| !own(table)) {
            return Err(SceneError::for_key(
                format!("cam_table[{i}]"),
                "is given beside [five_bar], whose path makes the tables of both joints; leave it out",
            ));
        }
        let is_own = |axis: &AxisOverrides| match &axis.cam {
            Some(cam) => JOINTS.get(axis.number).is_some_and(|own| cam == own),
            None => true,
        };
        let given = |axis: &AxisOverrides| axis.cam_shift_deg != 0.0 || !is_own(axis);
        if let Some(i) = scene.axis.iter().position(given) {
            return Err(SceneError::for_key(
                format!("axis[{i}].cam"),
                "is given beside [five_bar], whose path makes the tables of both joints; leave it and cam_shift_deg out",
            ));
        }
        scene.cam_table = JOINTS
            .iter()
            .zip(tables)
            .map(|(name, points_turns)| CamTable::of_points(name, points_turns))
            .collect();
        for (number, name) in JOINTS.iter().enumerate() {
            if !scene.axis.iter().any(|own| own.number == number) {
                scene.axis.push(AxisOverrides::new(number));
            }
            for axis in scene.axis.iter_mut().filter(|axis| axis.number == number) {
                axis.cam = Some((*name).to_owned());
            }
        }
        let amax_g = path.nominal_mps2() / STANDARD_GRAVITY_MPS2;
        for level in &mut scene.program {
            if level.amax_g.is_none() && level.repeat.is_none() && level.segments.is_none() {
                level.amax_g = Some(amax_g);
            }
        }
        Ok(())
    }

    fn make(&self, scene: &Scene) -> Result<Made, SceneError> {
        check(self)?;
        let path = path(self)?;
        let tables = tables(self, &path)?;
        let arm = arm(self, scene, path, tables);
        Made::square_law(scene, self.key(), "five_bar.path_mm", Arc::new(arm))
    }
}
