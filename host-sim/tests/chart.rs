//! Charts as a user gets them.

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

fn chart(arguments: &[&str]) -> Output {
    Command::cargo_bin("cophase")
        .expect("the command is built")
        .arg("chart")
        .args(arguments)
        .output()
        .expect("it runs")
}

fn drawn(name: &str, folder: &Path) -> (String, String) {
    let output = chart(&[name, "--out", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let read = |kind: &str| std::fs::read_to_string(folder.join(format!("{name}.{kind}"))).unwrap();
    (read("csv"), read("svg"))
}

/// Were it wrong, the picture would say of a method what its theory denies.
#[test]
fn edges_of_stability_are_those_of_theory() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, _) = drawn("stability", folder.path());
    let mut compared = 0;
    for record in csv::Reader::from_reader(csv.as_bytes()).records() {
        let record = record.unwrap();
        let (method, zeta) = (&record[0], &record[1]);
        match (record[2].parse::<f64>(), record[3].parse::<f64>()) {
            (Ok(measured), Ok(theory)) => {
                assert!(
                    (measured - theory).abs() <= 0.01 * theory.max(1e-6),
                    "{method} at {zeta}: {measured}, not {theory}"
                );
                compared += 1;
            }
            // Either has no number: none has an edge, or theory has no closed form.
            _ => assert!(record[3].is_empty() || record[2] == record[3], "{record:?}"),
        }
    }
    assert!(compared > 1000, "{compared} rows");
}

/// Were it wrong, a chart in the docs could not be told from another of the same name.
#[test]
fn a_chart_is_the_same_each_time() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let [one, other] = folders
        .each_ref()
        .map(|folder| drawn("stability", folder.path()));
    assert_eq!(one, other);
    assert!(one.1.starts_with("<svg") && one.1.contains("velocity Verlet"));
}

#[test]
fn charts_are_listed_and_others_refused() {
    let list = String::from_utf8(chart(&["list"]).stdout).unwrap();
    for name in ["methods", "stability"] {
        assert!(list.lines().any(|line| line.starts_with(name)), "{list}");
    }
    let refused = chart(&["stabilty", "--out", "/nowhere"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.contains("did you mean `stability`?"), "{said}");
    assert!(refused.stdout.is_empty());
}
