//! Completion scripts and manual pages. Shells and readers of manual pages accept them, and no subcommand is left out.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

fn cophase(arguments: &[&str]) -> Output {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_cophase"));
    command.args(arguments).output().unwrap()
}

fn printed(arguments: &[&str]) -> String {
    let output = cophase(arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Returns the subcommands that `--help` of a command lists.
fn subcommands(of: &[&str]) -> Vec<String> {
    let help = printed(&[of, &["--help"]].concat());
    let lines = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty());
    lines
        .filter(|line| line.starts_with("  ") && !line.starts_with("   ")) // other lines continue a line
        .map(|line| line.split_whitespace().next().unwrap().to_owned())
        .filter(|name| name != "help")
        .collect()
}

/// Adds the file names of the pages of a command and of all commands below it.
fn expected_pages(of: &[&str], pages: &mut BTreeSet<String>) {
    let name: Vec<&str> = [&["cophase"], of].concat();
    pages.insert(format!("{}.1", name.join("-")));
    for subcommand in subcommands(of) {
        expected_pages(&[of, &[&subcommand]].concat(), pages);
    }
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.unwrap().file_name().into_string().unwrap()
    };
    entries.map(name).collect()
}

/// Runs a program of the system on a file. Returns none where there is no such program.
fn run_on(program: &str, arguments: &[&str], file: &Path) -> Option<Output> {
    match Command::new(program).args(arguments).arg(file).output() {
        Ok(output) => Some(output),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
        Err(error) => panic!("{program}: {error}"),
    }
}

/// If this fails, a shell gets a script that it cannot read, or a script that lacks a subcommand.
#[test]
fn each_completion_script_is_valid_and_has_all_subcommands() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = printed(&["completions", shell]);
        for subcommand in subcommands(&[]) {
            assert!(script.contains(&subcommand), "{shell}: no {subcommand}");
        }
        assert!(script.contains("detect-at-once"), "{shell}");
        let file = folder.path().join(shell);
        std::fs::write(&file, script).unwrap();
        let parse_only = match shell {
            "bash" | "zsh" => "-n",
            "fish" => "--no-execute",
            _ => continue,
        };
        if let Some(output) = run_on(shell, &[parse_only], &file) {
            assert!(output.status.success(), "{shell}: {output:?}");
            assert!(output.stderr.is_empty(), "{shell}: {output:?}");
        }
    }
}

/// If this fails, bash does not complete as the script specifies.
#[test]
fn bash_completes_subcommands_and_options() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("script");
    std::fs::write(&script, printed(&["completions", "bash"])).unwrap();
    let completed = |words: &[&str]| -> Option<Vec<String>> {
        let line = format!(
            ". \"$0\"; COMP_WORDS=(cophase {}); COMP_CWORD={}; _cophase cophase {last} {before}; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
            words.join(" "),
            words.len(),
            last = words[words.len() - 1],
            before = words.iter().rev().nth(1).unwrap_or(&"cophase"),
        );
        let output = run_on("bash", &["-c", &line], &script)?;
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        Some(text.lines().map(str::to_owned).collect())
    };
    if let Some(replies) = completed(&["sc"]) {
        assert_eq!(replies, ["scope", "scenes"].map(str::to_owned));
    }
    if let Some(replies) = completed(&["link", "--take"]) {
        assert_eq!(replies, ["--take-over".to_owned()]);
    }
}

/// If this fails, a subcommand has no manual page, or a page does not render.
#[test]
fn each_subcommand_has_a_manual_page_that_renders() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("new/man1");
    printed(&["man", pages.to_str().unwrap()]);
    let mut expected = BTreeSet::new();
    expected_pages(&[], &mut expected);
    assert!(expected.contains("cophase-link-bring-up-axis.1"));
    assert_eq!(names(&pages), expected);

    for name in &expected {
        let page = pages.join(name);
        let text = std::fs::read_to_string(&page).unwrap();
        assert!(text.contains(".SH NAME") && text.contains(".SH SYNOPSIS"));
        let readers: [(&str, &[&str]); 2] = [
            ("groff", &["-man", "-Kutf8", "-Tutf8", "-ww", "-z"]),
            ("mandoc", &["-Tlint", "-Werror"]),
        ];
        for (reader, arguments) in readers {
            if let Some(output) = run_on(reader, arguments, &page) {
                let said = String::from_utf8_lossy(&output.stderr);
                assert!(
                    output.status.success() && said.is_empty(),
                    "{reader} {name}: {said}"
                );
            }
        }
    }
}

/// If this fails, an unknown shell or an unusable folder is not refused clearly.
#[test]
fn bad_arguments_are_refused() {
    let refused = |arguments: &[&str], what: &str| {
        let output = cophase(arguments);
        let words = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{words}");
        assert!(words.contains(what), "{words}");
        assert!(output.stdout.is_empty());
    };
    refused(&["completions", "ksh"], "bash");
    refused(&["completions"], "<SHELL>");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").unwrap();
    refused(
        &["man", file.to_str().unwrap()],
        "give a folder that can be written",
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
}
