//! An axis: its label with its unit, what is shown of it, and how it is divided.

use std::sync::Arc;

use kuva::render::layout::{Layout, TickFormat};

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    label: String,
    from: f64,
    to: f64,
    is_log: bool,
}

/// kuva has no ticks below 1e-10 on a logarithmic axis; what is drawn there is so much larger, and its labels so much
/// smaller.
const LIFT: f64 = 1e20;

impl Axis {
    /// A logarithmic one, of a label with its unit, and what is shown.
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

    /// A linear one, of a label with its unit, and what is shown.
    pub fn linear(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self {
            is_log: false,
            ..Self::log(label, from, to)
        }
    }

    /// Whether a value has a place on it, be it beyond its ends.
    pub fn can_show(&self, value: f64) -> bool {
        value.is_finite() && (!self.is_log || value > 0.0)
    }

    /// What kuva is to draw for a value.
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

    /// Plain numbers where all of them are short, else powers of ten.
    fn ticks(&self) -> TickFormat {
        let is_plain = self.from >= 0.009 && self.to <= 11_000.0;
        TickFormat::Custom(Arc::new(move |lifted| told(lifted / LIFT, is_plain)))
    }
}

fn told(value: f64, is_plain: bool) -> String {
    // 1, 2 and 5 in each decade are all that is asked for; what is left of rounding goes with {:.0}.
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

    /// Were it wrong, a reader would be off by powers of ten.
    #[test]
    fn ticks_are_told_as_people_write_them() {
        for (value, is_plain, text) in [
            (1e-12, false, "10⁻¹²"),
            (2e5, false, "2·10⁵"),
            (1.0, false, "1"),
            (0.05, true, "0.05"),
            (500.0, true, "500"),
        ] {
            assert_eq!(told(value * LIFT / LIFT, is_plain), text);
        }
    }
}
