//! Keys of a scene file, read without the types of the program.

use toml::{Table, Value};

/// Numbers of a scene by which its run is judged.
pub struct Stated {
    pub tick_s: f64,
    pub count: usize,
    pub speed_hz: f64,
    pub homing_hz: f64,
    pub acceleration: f64,
    pub jerk: f64,
    /// Forbidden bands, rev/s.
    pub bands: Vec<(f64, f64)>,
    /// Largest rate of a phase offset, turns a second: of any, as homing sets them, and of one in the program. That is 0 without correction.
    pub homing_offset_hz: f64,
    pub offset_hz: f64,
    /// Steps, or counts, of each axis per turn of its crank.
    pub steps: Vec<f64>,
    /// Levels of the program, m/s².
    pub levels_mps2: Vec<f64>,
    /// True if an axis makes other than one turn per turn of the master.
    pub turns_otherwise: bool,
}

fn number(value: Option<&Value>) -> Option<f64> {
    let value = value?;
    value.as_float().or(value.as_integer().map(|i| i as f64))
}

/// Quotient of a pair such as `gear = [57, 11]`.
fn quotient(table: Option<&Table>, key: &str) -> Option<f64> {
    let pair = table?.get(key)?.as_array()?;
    Some(number(pair.first())? / number(pair.get(1))?)
}

fn levels(entries: Option<&Value>, found: &mut Vec<f64>) {
    for entry in entries.and_then(Value::as_array).into_iter().flatten() {
        if let Some(amax_g) = number(entry.get("amax_g")) {
            found.push(amax_g * super::G_MPS2);
        }
        levels(entry.get("segments"), found);
    }
}

impl Stated {
    pub fn read(text: &str) -> Option<Self> {
        let table: Table = text.parse().ok()?;
        let section = |name: &str| table.get(name).and_then(Value::as_table);
        let (limits, axes) = (section("limits")?, section("axes")?);
        let of = |section: &Table, key: &str| number(section.get(key));
        let count = of(axes, "count")? as usize;
        let own = |axis: usize| {
            let all = table.get("axis")?.as_array()?.iter();
            all.filter_map(Value::as_table)
                .find(|own| of(own, "number") == Some(axis as f64))
        };
        let gear = |axis| {
            let common = || quotient(Some(axes), "gear");
            quotient(own(axis), "gear").or_else(common).unwrap_or(1.0)
        };
        let per_turn = |axis| {
            let own = own(axis).and_then(|own| of(own, "steps_per_turn"));
            Some(own.or_else(|| of(axes, "steps_per_turn"))? * gear(axis))
        };
        let ratios = (0..count).map(own).chain([Some(axes)]);
        let band = |band: &Value| Some((number(band.get("from_hz"))?, number(band.get("to_hz"))?));
        let bands = limits.get("band").and_then(Value::as_array);
        let correction = section("correction");
        let has_offsets = correction.is_some_and(|correction| {
            let gain = of(correction, "gain").unwrap_or_default();
            gain > 0.0 || correction.get("prove_wiring").and_then(Value::as_bool) == Some(true)
        });
        let rate_hz = of(axes, "trim_rate_deg_per_s")? / 360.0;
        let mut levels_mps2 = Vec::new();
        levels(table.get("program"), &mut levels_mps2);
        Some(Self {
            tick_s: 1.0 / section("control").and_then(|control| of(control, "tick_hz"))?,
            count,
            speed_hz: of(limits, "speed_hz")?,
            homing_hz: of(limits, "homing_speed_hz")?,
            acceleration: of(limits, "acceleration_hz_per_s")?,
            jerk: of(limits, "jerk_hz_per_s2")?,
            bands: bands.into_iter().flatten().filter_map(band).collect(),
            homing_offset_hz: rate_hz,
            offset_hz: if has_offsets { rate_hz } else { 0.0 },
            steps: (0..count).map(per_turn).collect::<Option<_>>()?,
            levels_mps2,
            turns_otherwise: ratios
                .filter_map(|table| quotient(table, "ratio"))
                .any(|ratio| ratio != 1.0),
        })
    }

    /// Largest change of a phase offset in a time of the program, turns. Offsets move by whole steps.
    pub fn offset_turns(&self, step: f64, time_s: f64) -> f64 {
        if self.offset_hz > 0.0 {
            self.offset_hz * time_s + step
        } else {
            0.0
        }
    }
}
