//! The plain methods: a table alone, or a table with straight lines between its entries.
//!
//! Sine and cosine share one quarter wave of 1,025 entries with 30 fraction bits. Root and arctangent have a table each.

const STEPS: usize = 1024;
const REST_BITS: u32 = 20; // bits of the angle below a step
const QUARTER: u32 = 1 << 30;

static QUARTER_WAVE: [i32; STEPS + 1] = quarter_wave();

/// The nearest entry.
pub fn sine_cosine_nearest(angle: u32) -> (i32, i32) {
    let rounded = angle.wrapping_add(1 << (REST_BITS - 1));
    let index = ((rounded & (QUARTER - 1)) >> REST_BITS) as usize;
    turned(rounded, QUARTER_WAVE[index], QUARTER_WAVE[STEPS - index])
}

/// A straight line between two entries, its product in 32 bits: 5 bits of the rest are dropped, and 5 of the step.
pub fn sine_cosine_linear(angle: u32) -> (i32, i32) {
    let index = ((angle & (QUARTER - 1)) >> REST_BITS) as usize;
    let rest = ((angle >> 5) & 0x7fff) as i32;
    let line = |from: i32, to: i32| from + ((((to - from) >> 5) * rest) >> 10);
    turned(
        angle,
        line(QUARTER_WAVE[index], QUARTER_WAVE[index + 1]),
        line(QUARTER_WAVE[STEPS - index], QUARTER_WAVE[STEPS - 1 - index]),
    )
}

/// The same with all bits of the rest, its product in 64 bits.
pub fn sine_cosine_linear_i64(angle: u32) -> (i32, i32) {
    let index = ((angle & (QUARTER - 1)) >> REST_BITS) as usize;
    let rest = i64::from(angle & ((1 << REST_BITS) - 1));
    let line = |from: i32, to: i32| from + ((i64::from(to - from) * rest) >> REST_BITS) as i32;
    turned(
        angle,
        line(QUARTER_WAVE[index], QUARTER_WAVE[index + 1]),
        line(QUARTER_WAVE[STEPS - index], QUARTER_WAVE[STEPS - 1 - index]),
    )
}

/// Sine and cosine of the first quarter, moved to the quarter of the angle.
fn turned(angle: u32, sine: i32, cosine: i32) -> (i32, i32) {
    match angle >> 30 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

const fn quarter_wave() -> [i32; STEPS + 1] {
    let mut table = [0; STEPS + 1];
    let mut i = 0;
    while i <= STEPS {
        let angle = core::f64::consts::FRAC_PI_2 * (i as f64) / (STEPS as f64);
        // Taylor's series
        let (mut term, mut sum, mut n) = (angle, angle, 1.0);
        while n < 25.0 {
            term = -term * angle * angle / ((n + 1.0) * (n + 2.0));
            sum += term;
            n += 2.0;
        }
        table[i] = (sum * QUARTER as f64 + 0.5) as i32;
        i += 1;
    }
    table
}

const ROOTS: usize = 192;

static ROOT: [u16; ROOTS + 1] = roots();

/// The root of `x`, with 16 fraction bits more than an integer root has after normalising: `x` from 2³⁰ up gives
/// 2³¹ and more. A straight line between entries.
pub fn root(x: u32) -> u32 {
    let index = (x >> 24).saturating_sub(64) as usize;
    let rest = (x >> 8) & 0xffff;
    let (low, high) = (u32::from(ROOT[index]), u32::from(ROOT[index + 1]));
    (low << 16) + (high - low) * rest
}

const fn roots() -> [u16; ROOTS + 1] {
    let mut table = [0; ROOTS + 1];
    let mut i = 0;
    while i <= ROOTS {
        // 16 bits of sqrt((64 + i) / 256), rounded; the last would be 2^16
        let exact = (64 + i as u64) << 26;
        let twice = exact.isqrt();
        let root = twice.div_ceil(2);
        table[i] = if root > 0xffff { 0xffff } else { root as u16 };
        i += 1;
    }
    table
}

const TANGENTS: usize = 256;

static ARCTANGENT: [u32; TANGENTS + 2] = arctangents();

/// Angle of a vector, 2³² to the turn: straight lines over the first octant, after a division.
pub fn arctangent(y: i32, x: i32) -> u32 {
    let (rise, run) = (y.unsigned_abs(), x.unsigned_abs());
    let (low, high) = if rise > run { (run, rise) } else { (rise, run) };
    if high == 0 {
        return 0;
    }
    let tangent = ((u64::from(low) << 28) / u64::from(high)) as u32;
    let (index, rest) = ((tangent >> 20) as usize, tangent & 0xfffff);
    let (from, to) = (ARCTANGENT[index], ARCTANGENT[index + 1]);
    let mut angle = from + ((u64::from(to - from) * u64::from(rest)) >> 20) as u32;
    if rise > run {
        angle = QUARTER - angle;
    }
    if x < 0 {
        angle = 2 * QUARTER - angle;
    }
    if y < 0 { angle.wrapping_neg() } else { angle }
}

/// The last entry is repeated, because there is none after it.
const fn arctangents() -> [u32; TANGENTS + 2] {
    let mut table = [0; TANGENTS + 2];
    let mut i = 0;
    while i < TANGENTS + 2 {
        let entry = if i > TANGENTS { TANGENTS } else { i };
        let x = entry as f64 / TANGENTS as f64;
        // Euler's series: each term is at most half the one before.
        let part = x * x / (1.0 + x * x);
        let (mut term, mut sum, mut n) = (x / (1.0 + x * x), 0.0, 1.0);
        while n < 60.0 {
            sum += term;
            term *= part * 2.0 * n / (2.0 * n + 1.0);
            n += 1.0;
        }
        table[i] = (sum / core::f64::consts::TAU * 4.0 * QUARTER as f64 + 0.5) as u32;
        i += 1;
    }
    table
}
