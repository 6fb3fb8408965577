"""The schema of scenes: it is valid, accepts all built-in and example scenes, and refuses scenes with one wrong key each.

Tombi, a language server, finds the schema by the first line of a printed scene.
"""

import json
import os
import pathlib
import re
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


def required(table):
    """Lines with the required keys of a table: values that the schema accepts."""
    words = {"number": 1, "integer": 4, "boolean": "true", "string": '"x"', "array": "[]", "object": "{}"}
    lines = []
    for key in table.get("required", []):
        rules = table["properties"][key]
        value = json.dumps(rules["enum"][0]) if "enum" in rules else words[rules["type"]]
        if rules["type"] == "array":
            value = [rules.get("minimum", 1)] * rules.get("minItems", 0)
        if "minimum" in rules:
            value = rules["minimum"]
        lines.append(f"{key} = {value}")
    return lines


def wrong_values(rules):
    """A problem and a value for each mistake that the schema is to refuse at a key."""
    wrong = {"number": '"much"', "integer": '"much"', "boolean": 1, "string": 1, "array": 1, "object": 1}
    yield "another type", wrong[rules["type"]]
    if rules["type"] == "integer":
        yield "a fraction", 1.5
    if "enum" in rules:
        yield "no such word", '"no-such-word"'
    if "minimum" in rules and rules["maximum"] < 2**31:
        yield "too low", rules["minimum"] - 1
        yield "too high", rules["maximum"] + 1


def wrong_scenes(schema):
    """A name and a text for each value that the schema is to refuse."""
    base = pathlib.Path("host-sim/scenes/default.toml").read_text()
    for name, rules in schema["properties"].items():
        table = rules.get("items", rules)
        if "properties" not in table:
            for problem, value in wrong_values(rules):
                yield f"{name}: {problem}", f"{name} = {value}\n" + re.sub(rf"(?m)^{name} = .*$", "", base)
            continue
        without = re.sub(rf"(?ms)^\[+{name}[\].].*?(?=^\[|\Z)", "", base)
        heading = f"[[{name}]]" if rules["type"] == "array" else f"[{name}]"

        def scene(*lines):
            return "\n".join([without, heading, *lines, ""])

        yield f"{name}: unknown key", scene(*required(table), "no_such_key = 1")
        yield f"{name}: no table", f"{name} = 1\n{without}"
        for key, inner in table["properties"].items():
            if "type" not in inner:
                continue
            lines = [line for line in required(table) if not line.startswith(f"{key} = ")]
            for problem, value in wrong_values(inner):
                yield f"{name}.{key}: {problem}", scene(*lines, f"{key} = {value}")


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
