//! Axis of a panel: its label with its unit, its range, and its ticks.

use std::sync::Arc;

use kuva::render::layout::{Layout, TickFormat};

/// Axis of a panel.
#[derive(Clone, Debug)]
pub struct Axis {
    label: String,
    from: f64,
    to: f64,
    is_log: bool,
}

/// Factor for small values. kuva has no ticks below 1e-10 on a logarithmic axis, so these values are drawn larger by this factor, and
/// their labels are smaller by it.
const LIFT: f64 = 1e20;

impl Axis {
    /// Creates a logarithmic axis with a label, its unit, and a range.
    pub fn log(label: impl Into<String>, from: f64, to: f64) -> Self {
        let is_log = true;
        let label = label.into();
        Self {
            label,
            from,
            to,
            is_log,
        }
    }

    /// Creates a linear axis with a label, its unit, and a range.
    pub fn linear(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self {
            is_log: false,
            ..Self::log(label, from, to)
        }
    }

    /// Returns true if a value has a position on the axis, also beyond its ends.
    pub fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (!self.is_log || value > 0.0)
    }

    /// Returns the value that kuva draws.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.is_log { value * LIFT } else { value }
    }

    pub(super) fn range(&self) -> (f64, f64) {
        (self.place(self.from), self.place(self.to))
    }

    pub(super) fn lay_out_x(&self, layout: Layout) -> Layout {
        let (from, to) = self.range();
        let layout = layout
            .with_x_axis_min(from)
            .with_x_axis_max(to)
            .with_x_label(self.label.clone());
        if self.is_log {
            layout.with_log_x().with_x_tick_format(self.ticks())
        } else {
            layout
        }
    }

    pub(super) fn lay_out_y(&self, layout: Layout) -> Layout {
        let (from, to) = self.range();
        let layout = layout
            .with_y_axis_min(from)
            .with_y_axis_max(to)
            .with_y_label(self.label.clone());
        if self.is_log {
            layout.with_log_y().with_y_tick_format(self.ticks())
        } else {
            layout
        }
    }

    /// Returns plain numbers if all of them are short, else powers of ten.
    fn ticks(&self) -> TickFormat {
        let is_plain = self.from >= 0.009 && self.to <= 11_000.0;
        TickFormat::Custom(Arc::new(move |lifted| tick_label(lifted / LIFT, is_plain)))
    }
}

fn tick_label(value: f64, is_plain: bool) -> String {
    // Only 1, 2 and 5 in each decade are needed. {:.0} removes the remaining rounding error.
    let exponent = (value.log10() + 1e-9).floor();
    let digit = value / 10.0_f64.powf(exponent);
    if is_plain {
        let decimals = (-exponent).max(0.0) as usize;
        return format!("{value:.decimals$}");
    }
    if exponent == 0.0 {
        return format!("{digit:.0}");
    }
    let power: String = format!("10{exponent:.0}")
        .chars()
        .enumerate()
        .map(|(i, c)| if i < 2 { c } else { raised(c) })
        .collect();
    match format!("{digit:.0}").as_str() {
        "1" => power,
        digit => format!("{digit}·{power}"),
    }
}

fn raised(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' | '4'..='9' => {
            char::from_u32(u32::from(c) - u32::from('0') + u32::from('⁰')).unwrap_or(c)
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, labels are wrong by powers of ten.
    #[test]
    fn tick_labels_are_powers_of_ten_or_plain_numbers() {
        for (value, is_plain, text) in [
            (1e-12, false, "10⁻¹²"),
            (2e5, false, "2·10⁵"),
            (1.0, false, "1"),
            (0.05, true, "0.05"),
            (500.0, true, "500"),
        ] {
            assert_eq!(tick_label(value * LIFT / LIFT, is_plain), text);
        }
    }
}
