//! The scenes in `examples/` end as their comments state.

use std::fs;
use std::path::Path;

use serde_json::Value;

/// End of a run as a scene states it.
#[derive(Debug, PartialEq)]
struct End {
    status: i32,
    /// Kind and axis of the fault, with its latest name.
    fault: Option<(String, u64)>,
}

impl End {
    /// Reads `# Expect: exit status 1, fault KIND on axis N.`, or the same without a fault.
    fn promised(scene: &str) -> Self {
        let line = scene
            .lines()
            .find_map(|line| line.strip_prefix("# Expect: exit status "))
            .expect("a line `# Expect: exit status …`");
        let line = line.strip_suffix('.').expect("a full stop");
        let (status, fault) = match line.split_once(", fault ") {
            None => (line, None),
            Some((status, fault)) => {
                let (kind, axis) = fault.split_once(" on axis ").expect("an axis");
                (status, Some((kind.to_owned(), axis.parse().unwrap())))
            }
        };
        Self {
            status: status.parse().unwrap(),
            fault,
        }
    }
}

/// If this fails, an example ends differently from its comment.
#[test]
fn each_example_ends_as_its_comment_states() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut promised_faults = 0;
    for entry in fs::read_dir(&examples).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|end| end != "toml") {
            continue;
        }
        let name = path.file_name().unwrap().to_str().unwrap();
        let promised = End::promised(&fs::read_to_string(&path).unwrap());
        promised_faults += usize::from(promised.fault.is_some());

        let folder = tempfile::tempdir().unwrap();
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
        command.current_dir(folder.path()).arg("run").arg(&path);
        let output = command.output().unwrap();
        let report = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
        let report: Value = serde_json::from_str(&report).unwrap();
        let fault = report["faults"].as_array().unwrap().last();
        let ended = End {
            status: output.status.code().unwrap(),
            fault: fault.map(|fault| {
                let kind = fault["kind"].as_str().unwrap().to_owned();
                (kind, fault["axis"].as_u64().unwrap())
            }),
        };
        assert_eq!(ended, promised, "{name}: {output:?}");
    }
    assert!(promised_faults > 0, "no example shows a fault");
}
