//! Picture of an operating range: three panels over the speed of the cranks.

use cophase_scene::units::STANDARD_GRAVITY_MPS2;
use host_sim::operating_range::OperatingRange;
use host_sim::style::{INK, MUTED, VERMILION, svg, text};
use kuva::plot::LinePlot;
use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::render::annotations::{ReferenceLine, ShadedRegion, TextAnnotation};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use crate::trace::{BAND, FONT, GAP, Panel, TIME_AXIS, embed, plain, short};

const WIDTH: f64 = 1200.0;
const LEFT: f64 = 78.0;
const TOP: f64 = 76.0;
/// Speeds at which curves are computed.
const SPEEDS: u32 = 160;
/// Margin beyond the limit of speed, and above the curves.
const ROOM: f64 = 1.08;
/// Colours of required and available torque, one pair for each kind of motor.
const MOTORS: [(&str, &str); 3] = [
    ("#0B2F5B", "#009E73"),
    ("#0072B2", "#CC79A7"),
    ("#56B4E9", "#444444"),
];

/// Colour of the torque that is required in a ramp.
const RAMP: &str = "#A6D0EC";

/// Panel under construction.
struct Draft {
    plots: Vec<Plot>,
    legend: Vec<LegendEntry>,
    lines: Vec<ReferenceLine>,
    texts: Vec<TextAnnotation>,
    /// Greatest value that is shown.
    top: f64,
}

impl Draft {
    fn new() -> Self {
        Self {
            plots: Vec::new(),
            legend: Vec::new(),
            lines: Vec::new(),
            texts: Vec::new(),
            top: 0.0,
        }
    }

    fn curve(&mut self, points: Vec<(f64, f64)>, colour: &str, width: f64) {
        let top = points.iter().map(|point| point.1).fold(0.0, f64::max);
        self.top = self.top.max(top);
        let line = LinePlot::new().with_data(points);
        let line = line.with_color(colour).with_stroke_width(width);
        self.plots.push(Plot::Line(line));
    }

    fn entry(&mut self, shape: LegendShape, colour: &str, label: String, is_dashed: bool) {
        self.legend.push(LegendEntry {
            label,
            color: colour.to_owned(),
            shape,
            dasharray: is_dashed.then(|| "6 4".to_owned()),
        });
    }

    /// Draws a limit as a horizontal line if it is near the curves, and adds it to the legend in any case.
    fn limit(&mut self, value: f64, name: &str) {
        let is_near = value <= 2.0 * self.top;
        if is_near {
            self.top = self.top.max(value);
            let line = ReferenceLine::horizontal(value);
            self.lines
                .push(line.with_color(VERMILION).with_stroke_width(1.2));
        }
        let beyond = if is_near { "" } else { " (above)" };
        self.entry(
            LegendShape::Line,
            VERMILION,
            format!("{name}{beyond}"),
            true,
        );
    }

    /// The panel, with the bands and the limit of speed.
    fn done(mut self, range: &OperatingRange, right_hz: f64, label: &'static str) -> Panel {
        let limit = ReferenceLine::vertical(range.speed_limit_hz());
        self.lines
            .push(limit.with_color(VERMILION).with_stroke_width(1.2));
        let top = (ROOM * self.top).max(1e-9);
        let mut layout = Layout::new((0.0, right_hz), (0.0, top))
            .with_x_axis_min(0.0)
            .with_x_axis_max(right_hz)
            .with_y_axis_min(0.0)
            .with_y_axis_max(top)
            .with_y_label(label)
            .with_legend_entries(self.legend)
            .with_legend_position(LegendPosition::OutsideRightTop)
            .with_legend_box(false);
        layout.reference_lines = self.lines;
        layout.annotations = self.texts;
        layout.shaded_regions = range
            .bands_hz()
            .map(|(from, to)| {
                ShadedRegion::vertical(from, to.min(right_hz))
                    .with_color(BAND)
                    .with_opacity(0.22)
            })
            .collect();
        Panel {
            plots: self.plots,
            layout,
            note: None,
        }
    }
}

/// Draws an operating range, as SVG text.
#[must_use]
pub fn draw_operating_range(range: &OperatingRange) -> String {
    Picture { range }.draw()
}

struct Picture<'a> {
    range: &'a OperatingRange,
}

impl Picture<'_> {
    fn draw(&self) -> String {
        let right_hz = ROOM * self.range.speed_limit_hz();
        let mut panels = vec![
            (self.torque(right_hz), 260.0),
            (self.amplitude(right_hz), 190.0),
        ];
        if (0..self.range.axes()).any(|axis| self.range.takes_pulses(axis)) {
            panels.push((self.steps(right_hz), 150.0));
        }
        let plots: f64 = panels.iter().map(|(_, height)| height + GAP).sum();
        let mut scene = Scene::new(WIDTH, TOP + plots - GAP + TIME_AXIS);
        scene.font_family = Some(FONT.to_owned());
        let title = format!("{}: operating range", self.range.name);
        text(&mut scene, (LEFT, 34.0), &title, 22, INK);
        text(&mut scene, (LEFT, 58.0), &self.subtitle(), 13, MUTED);
        let last = panels.len() - 1;
        let mut top = TOP;
        for (i, (panel, height)) in panels.into_iter().enumerate() {
            let label = (i == last).then(|| "speed of the cranks, rev/s".to_owned());
            embed(&mut scene, panel, i, top, height, label);
            top += height + GAP;
        }
        svg(&scene)
    }

    /// Part of the motors' torque that the program requires.
    fn subtitle(&self) -> String {
        let Some(load) = self.range.max_load() else {
            return String::new();
        };
        if !load.ratio.is_finite() {
            return format!(
                "axis {} has no torque left at {} rev/s, and the program goes up to {} rev/s",
                load.axis,
                short(load.speed_hz),
                short(self.range.top_hz)
            );
        }
        let is_alike = self.range.load_kinds().len() == 1;
        let motor = if is_alike {
            "a motor".to_owned()
        } else {
            format!("the motor of axis {}", load.axis)
        };
        format!(
            "Up to {} rev/s, the program's greatest speed, {motor} needs at most {:.0} % of its torque, at {} rev/s.",
            short(self.range.top_hz),
            100.0 * load.ratio,
            short(load.speed_hz)
        )
    }

    fn over_speed(&self, right_hz: f64, value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let speeds = (0..=SPEEDS).map(|i| right_hz * f64::from(i) / f64::from(SPEEDS));
        speeds.map(|hz| (hz, value(hz))).collect()
    }

    /// Torque of a motor: required at a steady speed and in the steepest ramp, and available.
    fn torque(&self, right_hz: f64) -> Panel {
        let mut draft = Draft::new();
        let available = |axis, hz| self.range.available_nm(axis, hz);
        let kinds = self.range.kinds(right_hz, available);
        let known = kinds
            .iter()
            .filter(|axes| available(axes[0], 0.0).is_some());
        for (axes, (_, colour)) in known.zip(MOTORS.into_iter().cycle()) {
            let curve = |hz| available(axes[0], hz).unwrap_or(0.0);
            let points = with_end(
                self.over_speed(right_hz, curve),
                curve,
                self.range.speed_limit_hz(),
            );
            draft.curve(points, colour, 2.4);
            let name = self.named("available", axes);
            draft.entry(LegendShape::Line, colour, name, false);
        }
        let ramp = self.range.acceleration_limit_hz_per_s();
        let kinds = self
            .range
            .kinds(right_hz, |axis, hz| self.range.required_nm(axis, hz, ramp));
        for (axes, (colour, _)) in kinds.iter().zip(MOTORS.into_iter().cycle()) {
            let curve = |hz| self.range.required_nm(axes[0], hz, ramp);
            draft.curve(self.over_speed(right_hz, curve), RAMP, 1.6);
            let curve = |hz| self.range.required_nm(axes[0], hz, 0.0);
            draft.curve(self.over_speed(right_hz, curve), colour, 1.8);
            let name = self.named("required", axes);
            draft.entry(LegendShape::Line, colour, name, false);
        }
        let name = "in the steepest ramp".to_owned();
        draft.entry(LegendShape::Line, RAMP, name, false);
        draft.done(self.range, right_hz, "torque of a motor, N·m")
    }

    /// Name of a curve. It states the axes if other axes have another curve.
    fn named(&self, name: &str, axes: &[usize]) -> String {
        if axes.len() == self.range.axes() {
            return name.to_owned();
        }
        let numbers: Vec<_> = axes.iter().map(usize::to_string).collect();
        format!("{name}, {}", numbers.join(" "))
    }

    /// Amplitude at a steady speed, with the levels of the program.
    fn amplitude(&self, right_hz: f64) -> Panel {
        let mut draft = Draft::new();
        let in_g = |mps2: f64| mps2 / STANDARD_GRAVITY_MPS2;
        let curve = self.over_speed(right_hz, |hz| in_g(self.range.amax_mps2(hz)));
        draft.curve(curve, "#0B2F5B", 1.8);
        let mut labelled = f64::INFINITY;
        for level in self.range.levels.iter().rev() {
            let (hz, g) = (level.speed_hz, in_g(level.amax_mps2));
            draft.curve(vec![(hz, 0.0), (hz, g)], MUTED, 1.0);
            // The texts of levels that are close together would overlap.
            if labelled - hz > 0.045 * right_hz {
                labelled = hz;
                let mut label = TextAnnotation::new(format!("{} g", plain(g)), hz, g);
                label.text_x -= 0.022 * right_hz;
                label.font_size = 12;
                draft.texts.push(label);
            }
        }
        draft.entry(LegendShape::Line, "#0B2F5B", "amax".to_owned(), false);
        draft.entry(
            LegendShape::Line,
            MUTED,
            "level of the program".to_owned(),
            false,
        );
        for (from, to) in self.range.bands_hz() {
            let name = format!("avoid {}–{}", plain(from), plain(to));
            draft.entry(LegendShape::Rect, "#F8E2B5", name, false);
        }
        let name = format!("limit {} rev/s", plain(self.range.speed_limit_hz()));
        draft.entry(LegendShape::Line, VERMILION, name, true);
        draft.done(self.range, right_hz, "amax, g")
    }

    /// Step rate, with the limits of planner and board.
    fn steps(&self, right_hz: f64) -> Panel {
        const KILO: f64 = 1e-3;
        let mut draft = Draft::new();
        let mut rates: Vec<(f64, Vec<usize>)> = Vec::new();
        for axis in (0..self.range.axes()).filter(|&axis| self.range.takes_pulses(axis)) {
            let steps = self.range.step_hz(axis, 1.0);
            match rates.iter_mut().find(|(other, _)| *other == steps) {
                Some((_, axes)) => axes.push(axis),
                None => rates.push((steps, vec![axis])),
            }
        }
        for ((steps, _), (colour, _)) in rates.iter().zip(MOTORS.into_iter().cycle()) {
            draft.curve(
                vec![(0.0, 0.0), (right_hz, KILO * steps * right_hz)],
                colour,
                1.8,
            );
            draft.entry(
                LegendShape::Line,
                colour,
                format!("{steps:.0} steps a turn"),
                false,
            );
        }
        let Some(planner_hz) = self.range.planner_step_hz() else {
            return draft.done(self.range, right_hz, "steps, 1000/s");
        };
        let mut limit = |who: &str, hz: f64| {
            draft.limit(KILO * hz, &format!("{who} {} k", short(KILO * hz)));
        };
        let max = rates.iter().map(|(steps, _)| *steps).fold(0.0, f64::max);
        // The board makes all steps that the planner plans if the tick is long enough for them.
        let board_hz = self
            .range
            .board_speed_hz()
            .map(|hz| hz.map(|hz| hz * max).filter(|hz| *hz < planner_hz));
        match board_hz {
            Ok(None) => limit("limit", planner_hz),
            Ok(Some(board_hz)) => {
                limit("planner", planner_hz);
                limit("RP2040", board_hz);
            }
            Err(_) => {
                limit("planner", planner_hz);
                let name = "not for the RP2040".to_owned();
                draft.entry(LegendShape::Line, VERMILION, name, true);
            }
        }
        draft.done(self.range, right_hz, "steps, 1000/s")
    }
}

/// Returns the curve with a vertical end if it falls to zero between two points, beyond the last point of a pull-out curve. A curve
/// that falls at the limit of speed ends there without a vertical line, which would hide the line of the limit.
fn with_end(points: Vec<(f64, f64)>, value: impl Fn(f64) -> f64, limit_hz: f64) -> Vec<(f64, f64)> {
    let falls = |pair: &[(f64, f64)]| pair[0].1 > 0.0 && pair[1].1 == 0.0;
    let Some(before) = points.windows(2).position(falls) else {
        return points;
    };
    let (mut low, mut high) = (points[before].0, points[before + 1].0);
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        if value(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let mut ended = points;
    if (low - limit_hz).abs() < 1e-6 * limit_hz {
        ended.truncate(before + 1);
        ended.push((low, value(low)));
    } else {
        ended.splice(before + 1..=before, [(low, value(low)), (low, 0.0)]);
    }
    ended
}

#[cfg(test)]
mod tests {
    use cophase_scene::load;
    use host_sim::checked::Checked;
    use host_sim::fidelity;
    use host_sim::model_level::Bounds;

    use super::*;

    /// If this fails, the printed summary and `torque.svg` give different parts of the motors' torque for the same run.
    #[test]
    fn all_outputs_state_the_same_part_of_the_torque() {
        let text = "name = \"mixer\"\n[machine]\ncrank_radius_mm = 9.97\nrod_length_mm = 45.33\nload_kg = 18\nplatform = \"above\"\n\
                    [limits]\nspeed_hz = 37\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
                    [axes]\ncount = 5\ndrive = \"pulse-servo\"\nsteps_per_turn = 4800\nrotor_inertia_kgm2 = 0.002\nfriction_nm = 0.3\n\
                    [axes.servo]\nlimit_nm = 25\nposition_gain_per_s = 100\nvelocity_gain_nms = 4.9\n\
                    [[program]]\namax_g = 60\nramp_s = 2\nhold_s = 1\n";
        let checked = Checked::new(load::parse(text).unwrap()).unwrap();
        let checked = fidelity::check(checked).unwrap();
        let range = OperatingRange::for_scene(&checked).unwrap().unwrap();
        // The equations of the slider-crank: x = R cos a + sqrt(L^2 - R^2 sin^2 a), and torque = -m (g + x'') dx/da / N.
        let (radius_m, rod_m) = (9.97e-3_f64, 45.33e-3_f64);
        let lambda = radius_m / rod_m;
        let omega2 = 60.0 * STANDARD_GRAVITY_MPS2 / (radius_m * (1.0 + lambda));
        let torque_nm = |alpha: f64| {
            let (sin, cos) = alpha.sin_cos();
            let root = (1.0 - lambda * lambda * sin * sin).sqrt();
            let slope_m = radius_m * (sin + lambda * sin * cos / root);
            let curvature =
                cos + lambda * ((2.0 * alpha).cos() + lambda * lambda * sin.powi(4)) / root.powi(3);
            let force_n = 18.0 * (STANDARD_GRAVITY_MPS2 - radius_m * omega2 * curvature);
            (force_n * slope_m / 5.0).abs() + 0.3
        };
        let max_nm = (0..36_000)
            .map(|i| torque_nm(f64::from(i) / 36_000.0 * std::f64::consts::TAU))
            .fold(0.0, f64::max);
        let ratio = range.max_load().unwrap().ratio;
        assert!(
            (ratio - max_nm / 25.0).abs() < 2e-3,
            "{ratio}, by hand {}",
            max_nm / 25.0
        );
        let percent = format!("{:.0} % of its torque", 100.0 * ratio);
        assert!(
            draw_operating_range(&range).contains(&percent),
            "{percent} in the picture"
        );
        let numbers = Bounds::new(&checked).unwrap().numbers();
        let percent = format!(
            "{:.0} % of their torque at a steady speed (bounds:",
            100.0 * ratio
        );
        assert!(numbers.contains(&percent), "{numbers}");
    }

    /// If this fails, the end of a pull-out curve hides the line of the limit of speed, or a curve does not end.
    #[test]
    fn a_pull_out_curve_ends_at_its_last_point() {
        let value = |hz: f64| if hz <= 5.0 { 2.0 } else { 0.0 };
        let points: Vec<_> = [0.0, 4.0, 6.0, 8.0].map(|hz| (hz, value(hz))).to_vec();
        let below = with_end(points.clone(), value, 7.0);
        assert_eq!(below.len(), 6);
        let [corner, foot] = [below[2], below[3]];
        assert!((corner.0 - 5.0).abs() < 1e-9 && corner.1 == 2.0);
        assert_eq!(foot, (corner.0, 0.0));
        let at_limit = with_end(points, value, 5.0);
        assert_eq!(at_limit.len(), 3);
        assert_eq!(at_limit[2], corner);
    }
}
