//! Suggestion for an unknown name.
//!
//! The *stem* of a key is the key without the unit at its end. `load_g` means `load_kg`, even if the letters differ much. So an equal
//! stem has priority over a similar spelling.

/// Endings that state a unit, in scenes or elsewhere.
const UNITS: &[&str] = &[
    "g", "kg", "lb", "t", "m", "cm", "mm", "um", "in", "s", "ms", "us", "ns", "min", "h", "hz",
    "khz", "mhz", "rpm", "rps", "mps", "mps2", "mps3", "deg", "rad", "mrad", "turns", "rev", "s2",
    "s3", "per", "kgm2", "kgmm2", "gcm2", "nm", "n",
];

/// Least similarity of two spellings. Below it, a suggestion would mislead.
const ALIKE: f64 = 0.8;

/// Returns the most similar known name, if one is similar enough.
pub fn nearest<'a>(unknown: &str, known: &[&'a str]) -> Option<&'a str> {
    let alike = |key: &str| strsim::jaro_winkler(unknown, key);
    let best = |among: Vec<&'a str>| {
        among
            .into_iter()
            .max_by(|a, b| alike(a).total_cmp(&alike(b)))
    };
    let same_stem = known
        .iter()
        .copied()
        .filter(|key| stem(key) == stem(unknown))
        .collect();
    best(same_stem)
        .or_else(|| best(known.to_vec()).filter(|key| strsim::jaro_winkler(unknown, key) >= ALIKE))
}

fn stem(key: &str) -> &str {
    let mut stem = key;
    while let Some((before, last)) = stem.rsplit_once('_') {
        if !UNITS.contains(&last) {
            break;
        }
        stem = before;
    }
    stem
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: &[&str] = &[
        "crank_radius_mm",
        "lambda",
        "rod_length_mm",
        "load_kg",
        "gravity_mps2",
        "mount_radius_mm",
    ];
    const LIMITS: &[&str] = &[
        "speed_hz",
        "acceleration_hz_per_s",
        "jerk_hz_per_s2",
        "homing_speed_hz",
    ];

    #[test]
    fn a_key_with_another_unit_finds_the_known_key() {
        for (unknown, known, meant) in [
            ("load_g", MACHINE, "load_kg"),
            ("load", MACHINE, "load_kg"),
            ("mount_radius_cm", MACHINE, "mount_radius_mm"),
            ("rod_length_m", MACHINE, "rod_length_mm"),
            ("gravity_g", MACHINE, "gravity_mps2"),
            ("speed_rpm", LIMITS, "speed_hz"),
            ("homing_speed_rev_per_min", LIMITS, "homing_speed_hz"),
            ("acceleration_hz", LIMITS, "acceleration_hz_per_s"),
            ("jerk_mps3", LIMITS, "jerk_hz_per_s2"),
        ] {
            assert_eq!(nearest(unknown, known), Some(meant), "{unknown}");
        }
    }

    #[test]
    fn a_typing_error_is_recognised_and_another_word_is_not() {
        assert_eq!(nearest("lamda", MACHINE), Some("lambda"));
        assert_eq!(nearest("lode_kg", MACHINE), Some("load_kg"));
        for unknown in ["colour", "x", "", "_", "_s"] {
            assert_eq!(nearest(unknown, MACHINE), None, "{unknown}");
        }
        let commands = ["start", "stop", "hold", "resume", "reset"];
        assert_eq!(nearest("jump", &commands), None);
        assert_eq!(nearest("stopp", &commands), Some("stop"));
        assert_eq!(nearest("anything", &[]), None);
    }
}
