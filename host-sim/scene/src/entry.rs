//! Names of list entries in messages. A key path counts entries from 0, while an `[[axis]]` entry has an axis number of its own.

/// Returns a key path with its list entries in words: `axis[1].number (2nd [[axis]] entry, axis 3)`.
///
/// `name` is the axis or the name of the outermost entry.
pub fn place(key: &str, name: Option<&str>) -> String {
    let mut entries = Vec::new();
    let mut is_inside = false;
    let mut table = String::new();
    for part in key.split('.') {
        let (list, indices) = part.split_once('[').unwrap_or((part, ""));
        let path = if table.is_empty() || is_inside {
            list.to_owned()
        } else {
            format!("{table}.{list}")
        };
        for (depth, index) in indices
            .split(['[', ']'])
            .filter_map(|digits| digits.parse().ok())
            .enumerate()
        {
            let nth = ordinal(index);
            // Lists at the top level are written as blocks; lists inside tables and entries have either of TOML's forms.
            entries.push(match depth {
                0 if table.is_empty() => format!("{nth} [[{path}]] entry"),
                0 => format!("{nth} entry of {path}"),
                _ => format!("{nth} item"),
            });
            is_inside = true;
        }
        table = path;
    }
    let Some(outermost) = entries.first_mut() else {
        return key.to_owned();
    };
    if let Some(name) = name {
        outermost.push_str(&format!(", {name}"));
    }
    entries.reverse();
    format!("{key} ({})", entries.join(" in the "))
}

/// Returns the ordinal of an entry that is counted from 0: `1st`.
pub fn ordinal(index: usize) -> String {
    let nth = index.saturating_add(1);
    let ending = match (nth % 100, nth % 10) {
        (11..=13, _) => "th",
        (_, 1) => "st",
        (_, 2) => "nd",
        (_, 3) => "rd",
        _ => "th",
    };
    format!("{nth}{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn array_entries_are_described_in_words() {
        for (key, name, words) in [
            ("limits.speed_hz", None, ""),
            (
                "axis[1].number",
                Some("axis 3"),
                "2nd [[axis]] entry, axis 3",
            ),
            ("program[10]", None, "11th [[program]] entry"),
            ("limits.band[2].from_hz", None, "3rd entry of limits.band"),
            ("axes.pull_out[21]", None, "22nd entry of axes.pull_out"),
            (
                "axes.pull_out[0][1]",
                None,
                "2nd item in the 1st entry of axes.pull_out",
            ),
            (
                "cam_table[0].segment[2].deg",
                Some("\"lift\""),
                "3rd entry of segment in the 1st [[cam_table]] entry, \"lift\"",
            ),
            (
                "program[3].segments[0].segments[110].ramp_s",
                None,
                "111th entry of segments in the 1st entry of segments in the 4th [[program]] entry",
            ),
        ] {
            let expected = match words {
                "" => key.to_owned(),
                words => format!("{key} ({words})"),
            };
            assert_eq!(place(key, name), expected);
        }
    }
}
