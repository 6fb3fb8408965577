"""The schema of scenes: it is valid, accepts all built-in and example scenes, and refuses scenes with one wrong key each.

Tombi, a language server, finds the schema by the first line of a printed scene.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

COPHASE = os.environ["COPHASE"]
TOOLS = pathlib.Path(sys.executable).parent
VALIDATOR = TOOLS / "check-jsonschema"


def cophase(*arguments):
    return subprocess.check_output([COPHASE, *arguments], text=True)


def built_in_names():
    """Names in the list of scenes: the first words of its indented lines."""
    lines = cophase("scenes").splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ")]


def wrong_scenes(schema):
    """A name and a text for each value that the schema is to refuse."""
    for table, keys in schema["properties"].items():
        yield f"{table}: unknown key", f"[{table}]\nno_such_key = 1\n"
        yield f"{table}: no table", f"{table} = 1\n"
        for key, rules in keys["properties"].items():
            values = {
                "too low": rules["minimum"] - 1,
                "too high": rules["maximum"] + 1,
                "text": '"much"',
                "a list": "[1]",
            }
            if rules["type"] == "integer":
                values["a fraction"] = rules["default"] + 0.5
            for problem, value in values.items():
                yield f"{table}.{key}: {problem}", f"[{table}]\n{key} = {value}\n"


def refused(schema_file, files):
    """Files that the validator refuses."""
    command = [VALIDATOR, "--schemafile", schema_file, "--output-format", "json", *files]
    report = json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True).stdout)
    assert not report.get("parse_errors"), report["parse_errors"]
    return {pathlib.Path(error["filename"]) for error in report.get("errors", [])}


def lint(file):
    """What Tombi says about a file beside the schema; empty if nothing."""
    ended = subprocess.run([TOOLS / "tombi", "lint", "--offline", file.name], cwd=file.parent, capture_output=True, text=True)
    return ended.stdout + ended.stderr if ended.returncode else ""


def main():
    schema = json.loads(cophase("scenes", "--schema"))
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        schema_file = folder / "scene.schema.json"
        schema_file.write_text(json.dumps(schema))
        subprocess.run([VALIDATOR, "--check-metaschema", schema_file], check=True, stdout=subprocess.DEVNULL)

        printed = []
        for name in built_in_names():
            printed.append(folder / f"{name}.toml")
            printed[-1].write_text(cophase("scenes", name))
        right = printed + sorted(pathlib.Path("examples").glob("*.toml"))
        wrong = {}
        for number, (problem, text) in enumerate(wrong_scenes(schema)):
            file = folder / f"wrong-{number}.toml"
            file.write_text(text)
            wrong[file] = problem

        found = refused(schema_file, right + list(wrong))
        words = {file: lint(file) for file in printed}
        misspelt = folder / "misspelt.toml"
        misspelt.write_text(cophase("scenes", "default").replace("tick_hz", "tick_khz"))
        named = lint(misspelt)
    failures = [f"Tombi refuses {file}: {text}" for file, text in words.items() if text]
    if "tick_khz" not in named:
        failures.append(f"Tombi does not name tick_khz: {named}")
    failures += [f"refused: {file}" for file in right if file in found]
    failures += [f"accepted: {problem}" for file, problem in wrong.items() if file not in found]
    if failures:
        sys.exit("\n".join(failures))
    print(f"schema: {len(right)} scenes accepted, {len(wrong)} wrong ones refused")


main()
