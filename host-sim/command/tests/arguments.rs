//! Refusal of wrong arguments: one sentence with the place, the problem and the fix, and the exit status 2.

use std::process::{Command, Stdio};

const COPHASE: &str = env!("CARGO_BIN_EXE_cophase");

/// Runs the command in an empty folder. Returns its line on standard error, and checks that it wrote nothing else.
fn refused(arguments: &[&str]) -> String {
    let place = tempfile::tempdir().unwrap();
    let mut command = Command::new(COPHASE);
    let output = command.args(arguments).current_dir(place.path()).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
    assert!(output.stdout.is_empty(), "{arguments:?}: {output:?}");
    assert_eq!(place.path().read_dir().unwrap().count(), 0, "{arguments:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{arguments:?}: {said}");
    said.trim_end()
        .strip_prefix("cophase: ")
        .expect(&said)
        .to_owned()
}

/// If this fails, a newcomer gets a paragraph of the parser that leaves out the fix.
#[test]
fn each_wrong_argument_gets_one_sentence_with_problem_and_fix() {
    for (arguments, expected) in [
        (
            &["rnu"][..],
            "rnu: `cophase` has no such command; there are run, settings, link, scope, scenes, campaign, chart, reproduced, compare, \
             design, completions, man",
        ),
        (
            &["design", "crank-roker"],
            "crank-roker: `cophase design` has no such command; did you mean `crank-rocker`? there are crank-rocker, five-bar, \
             flywheel, screen",
        ),
        (
            &["link", "bring-up", "--to", "sim"],
            "`cophase link bring-up`: a further command is missing; give one of inputs, output, axis",
        ),
        (
            &["run", "--axes", "3"],
            "--axes: `cophase run` has no such option; `cophase run --help` has all",
        ),
        (
            &["campaign", "--sed", "3"],
            "--sed: `cophase campaign` has no such option; did you mean `--seed`? `cophase campaign --help` has all",
        ),
        (
            &["link", "bring-up", "axis", "1", "--ye"],
            "--ye: `cophase link bring-up axis` has no such option; did you mean `--yes`? `cophase link bring-up axis --help` has all",
        ),
        (
            &["--quiet", "run"],
            "--quiet: `cophase` has no such option; give it after `cophase run`",
        ),
        (
            &["link", "--yes", "home"],
            "--yes: `cophase link` has no such option; give it after `cophase link home`",
        ),
        (
            &["link", "--axes", "home"],
            "--axes: `cophase link` has no such option; `cophase link --help` has all",
        ),
        (
            &["run", "default", "extra"],
            "extra: `cophase run` takes no further argument; leave it out, or see `cophase run --help`",
        ),
        (
            &["run", "--every"],
            "--every: its value is missing; give --every <N>, or see `cophase run --help`",
        ),
        (
            &["run", "--out", ""],
            "--out: its value is missing; give --out <DIR>, or see `cophase run --help`",
        ),
        (
            &["run", ""],
            "'': there is no built-in scene of that name; there are default, coupling-slip, patent-1, patent-2, patent-3, patent-4, lost-steps, \
             stiff-bearing, pulse-servo, scotch-yoke, crank-rocker, suspended, wrapper, screen, jaw-crusher, five-bar, electronic-cam; \
             nor is there a file of that name",
        ),
        (
            &["scenes", ""],
            "'': there is no built-in scene of that name; there are default, coupling-slip, patent-1, patent-2, patent-3, patent-4, lost-steps, \
             stiff-bearing, pulse-servo, scotch-yoke, crank-rocker, suspended, wrapper, screen, jaw-crusher, five-bar, electronic-cam",
        ),
        (
            &["chart", ""],
            "'': there is no chart of that name; there are methods, stability, energy, functions, tick-rate, fidelity, decisions, \
             breakdown, change-detection",
        ),
        (
            &["run", "--quiet=3"],
            "--quiet: takes no value; leave 3 out",
        ),
        (
            &["design", "flywheel", "--nodes", "-4"],
            "--nodes -4: give a whole number, 4 to 10000",
        ),
        (
            &["run", "--every", "-3"],
            "--every -3: give a whole number, 1 or more; it counts control ticks",
        ),
        (
            &["run", "--trace", "csv,fsdb"],
            "--trace fsdb: there is no such value; give one of csv, vcd, fst, mcap",
        ),
        (
            &["completions", "fsh"],
            "<SHELL> fsh: there is no such value; did you mean `fish`? give one of bash, elvish, fish, powershell, zsh",
        ),
        (
            &["campaign", "--seed", ""],
            "--seed '': give a whole number, 0 or more",
        ),
        (
            &["campaign", "--runs", "1e4"],
            "--runs 1e4: give a whole number, 1 or more: 10000",
        ),
        (
            &["campaign", "--seed", "99999999999999999999"],
            "--seed 99999999999999999999: give a whole number, 0 to 18446744073709551615",
        ),
        (
            &["campaign", "--shard", "1/2"],
            "--shard: `cophase campaign` has no such option; `cophase campaign --help` has all",
        ),
        (
            &["campaign", "--threads", "0"],
            "--threads 0: give a whole number, 1 to 1024",
        ),
        (
            &["campaign", "--clean"],
            "--replay <K>: missing; give `cophase campaign --replay <K> --clean [SCENE]`, or see `cophase campaign --help`",
        ),
        (
            &["campaign", "--replay", "3", "--join", "x"],
            "--replay <K>: cannot be used with --join <PATH>...; leave one of the two out",
        ),
        (
            &["campaign", "--join", "d", "--runs", "5", "--seed", "3"],
            "--join <PATH>...: cannot be used with --runs <N>, --seed <S>; leave it, or them, out",
        ),
        (
            &["design", "--load-kg", "5", "crank-rocker"],
            "`cophase design crank-rocker`: cannot be used with --load-kg <M>; leave one of the two out",
        ),
        (
            &["campaign", "--others", "4", "--replay", "3"],
            "--others: needs --only, as it is for the cases that --only leaves out; give --only, or leave --others out",
        ),
        (
            &["campaign", "--others", "4", "--runs", "3"],
            "--others: needs --only, as it is for the cases that --only leaves out; give --only, or leave --others out",
        ),
        (
            &["campaign", "--others", "4", "--join", "x"],
            "--others <K>: cannot be used with --join <PATH>...; leave one of the two out",
        ),
        (
            &["campaign", "--seed", "3", "--seed", "4"],
            "--seed <S>: given twice; give it once",
        ),
        (
            &["campaign", "--join", "nowhere"],
            "nowhere: cannot be opened: No such file or directory (os error 2); give shards, or a folder with them",
        ),
        (
            &["compare", "a"],
            "<B>: missing; give `cophase compare <A> <B>`, or see `cophase compare --help`",
        ),
        (
            &["design", "five-bar", "--l1-m", "one"],
            "--l1-m one: give a number without a unit, with a point for fractions, such as 12.5",
        ),
        (
            &["link", "override", "-5"],
            "<PERCENT> -5: give a number without a unit, 0 to 120",
        ),
        (
            &["link", "override", "80%"],
            "<PERCENT> 80%: give a number without a unit, 0 to 120: 80",
        ),
        (
            &["link", "jog", "--for", "10s"],
            "--for 10s: give seconds without a unit, 0 to 1,000,000: 10",
        ),
        (
            &["link", "jog", "--for", "500ms"],
            "--for 500ms: give seconds without a unit, 0 to 1,000,000",
        ),
        (
            &["design", "--amax-g", "10g"],
            "--amax-g 10g: give a number without a unit, with a point for fractions: 10",
        ),
        (
            &["design", "--load-kg", "1,5"],
            "--load-kg 1,5: give a number without a unit, with a point for fractions: 1.5",
        ),
        (
            &["design", "--load-kg", "500g"],
            "--load-kg 500g: give a number without a unit, with a point for fractions, such as 12.5",
        ),
        (
            &["campaign", "--threads", "4 threads"],
            "--threads 4 threads: give a whole number, 1 to 1024: 4",
        ),
        (
            &["run", "--window", "0s..1,5s"],
            "--window 0s..1,5s: give FROM..TO in seconds, 0 or later, without a unit, with a point for fractions: 0..1.5",
        ),
        (
            &["run", "--real-time=2x"],
            "--real-time 2x: give simulated seconds per second, 0.001 to 1000: 2",
        ),
        (
            &["compare", "a", "b", "--tolerance", "accel_mps2=0.5m/s2"],
            "--tolerance accel_mps2=0.5m/s2: `0.5m/s2` is no number; give COLUMN=VALUE, without a unit, with a point for fractions: \
             accel_mps2=0.5",
        ),
        (
            &["run", "--udp", "127.0.0.1"],
            "--udp 127.0.0.1: the port is missing; give 127.0.0.1:PORT of the receiver, such as 127.0.0.1:9870",
        ),
        (
            &["link", "identify", "--to", "tcp:127.0.0.1"],
            "--to tcp:127.0.0.1: the port is missing; give tcp:127.0.0.1:PORT, where the controller's server listens",
        ),
        (
            &["link", "identify", "--to", "http://127.0.0.1:18080"],
            "--to http://127.0.0.1:18080: is a web address; for a controller's server at that address, give --to tcp:127.0.0.1:18080",
        ),
        (
            &["compare", "default", "b"],
            "default: is the name of a built-in scene, not a run; run it first: cophase run default --out DIR, then compare DIR",
        ),
        (
            &["link", "bring-up", "axis", "9"],
            "<AXIS> 9: give a whole number, 0 to 5",
        ),
        (
            &["scope", "--listen", "here"],
            "--listen here: give an address of this computer in numbers, such as 127.0.0.1",
        ),
        (
            &["scope", "--listen", "127.0.0.1:8080"],
            "--listen 127.0.0.1:8080: it takes an address without a port; give --listen 127.0.0.1 --port 8080",
        ),
        (
            &["scope", "--listen", "[::1]:8080"],
            "--listen [::1]:8080: it takes an address without a port; give --listen ::1 --port 8080",
        ),
        (
            &["scope", "--listen", "[::1]"],
            "--listen [::1]: it takes an address alone; give --listen ::1",
        ),
        (
            &["scope", "--listen", "localhost:8080"],
            "--listen localhost:8080: it takes an address in numbers, without a port; give one of this computer, such as \
             --listen 127.0.0.1 --port 8080",
        ),
        (
            &["scope", "--port", "99999"],
            "--port 99999: give a whole number, 0 to 65535",
        ),
    ] {
        assert_eq!(refused(arguments), expected, "{arguments:?}");
    }
}

/// If this fails, a citation names another version than the one that was used.
#[test]
fn the_citation_has_the_version_of_the_command() {
    let citation = include_str!("../../../CITATION.cff");
    let version = concat!("\nversion: ", env!("CARGO_PKG_VERSION"), "\n");
    assert!(citation.contains(version), "{citation}");
}

/// If this fails, a user cannot say which build printed a figure. The report and the trace have the same words.
#[test]
fn version_and_commit_are_those_of_all_files() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().to_str().unwrap();
    let cophase = |arguments: &[&str]| {
        let output = Command::new(COPHASE).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let said = cophase(&["--version"]);
    let (version, commit) = said.trim().split_once(" (commit ").unwrap();
    let (version, commit) = (
        version.split_once(' ').unwrap().1,
        commit.trim_end_matches(')'),
    );
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
    let digits = commit.trim_end_matches("-changed");
    let is_digits = digits.len() >= 12 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    assert!(commit == "unknown" || is_digits, "{commit}");
    cophase(&["run", "coupling-slip", "--quiet", "--out", out]);
    let read = |name: &str| std::fs::read_to_string(place.path().join(name)).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(
        (&report["version"], &report["commit"]),
        (&version.into(), &commit.into())
    );
    let end = format!(",{version},{commit}");
    assert!(
        read("trace.csv")
            .lines()
            .skip(1)
            .all(|line| line.ends_with(&end))
    );
}

/// If this fails, an output folder that cannot be written is found only after hours of simulation.
#[test]
fn an_unusable_folder_is_refused_before_the_work() {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("taken"), "mine").unwrap();
    for (arguments, option) in [
        (&["campaign", "--runs", "100000000"][..], "--out"),
        (&["chart", "breakdown"], "-o"),
    ] {
        let mut command = assert_cmd::Command::new(COPHASE);
        command
            .args(arguments)
            .args([option, "taken"])
            .current_dir(place.path());
        let output = command.timeout(std::time::Duration::from_secs(60)).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            said.contains("--out: cannot create the folder taken"),
            "{said}"
        );
    }
}

/// If this fails, a user has to search the argument with the wrong bytes.
#[cfg(unix)]
#[test]
fn an_argument_that_is_not_utf_8_is_named() {
    use std::os::unix::ffi::OsStrExt;

    let mut command = Command::new(COPHASE);
    command.args(["run", "--every", "2"]);
    command.arg(std::ffi::OsStr::from_bytes(b"caf\xe9.toml"));
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        said,
        "cophase: caf\u{fffd}.toml: not UTF-8; give it in UTF-8\n"
    );
}

/// Pages of help are no refusals: those that are requested, and those of a command that needs a further word.
#[test]
fn help_is_printed_in_full_and_only_requested_help_succeeds() {
    for (arguments, status) in [
        (&["--help"][..], 0),
        (&["campaign", "--help"], 0),
        (&["--version"], 0),
        (&[], 2),
        (&["link"], 2),
    ] {
        let output = Command::new(COPHASE).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(status), "{arguments:?}");
        let said = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        let is_page = arguments == ["--version"] || said.concat().contains("Usage: cophase");
        assert!(
            is_page && said[usize::from(status == 0)].is_empty(),
            "{said:?}"
        );
    }
}

/// If this fails, `cophase scenes | head` ends with an error, or with a panic.
#[test]
fn a_closed_pipe_ends_the_command_without_an_error() {
    for arguments in [
        &["scenes"][..],
        &["scenes", "default"],
        &["run", "--help"],
        &["chart", "list"],
    ] {
        let mut command = Command::new(COPHASE);
        command
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {output:?}");
        assert!(output.stderr.is_empty(), "{arguments:?}: {output:?}");
    }
}
