"""Pictures and data of docs/, with the commands that make them: the table is figures.toml.

A *quick* figure is made again and compared byte for byte; `from` is where its command writes it, if not to its place. A *long* one is
not: its `inputs` are hashed instead, source files without comments, or CI measures it `elsewhere`, in a step of `.ci/run`.
`undetected` says which changes are not seen.
"""
import fnmatch
import hashlib
import os
import pathlib
import re
import tempfile
import tomllib

import cargo
from pages import ROOT, tracked
from prose import LEXERS, language

TABLE = ROOT / 'tests/docs/figures.toml'
KINDS = ('docs/*.svg', 'docs/*.png', 'docs/*.csv')


def table():
    return tomllib.loads(TABLE.read_text())['figure']


def code(name):
    """Bytes of a file that count: without the comments and the layout of source files."""
    content = (ROOT / name).read_bytes()
    if not name.endswith(('.rs', '.py', '.mjs')):
        return content
    text = content.decode()
    text = LEXERS[language(name, text)].sub(lambda m: ' ' if m['comment'] else m[0], text)
    return re.sub(r'\s+', '', text).encode()


def digest(patterns, names=None):
    """Hash of the files that match; `**` is any depth."""
    all_names = tracked() if names is None else names
    found = sorted({name for pattern in patterns for name in all_names if fnmatch.fnmatch(name, pattern.replace('**', '*'))})
    whole = hashlib.sha256()
    for name in found:
        whole.update(f'{name}\0'.encode() + hashlib.sha256(code(name)).digest())
    return whole.hexdigest()[:16], found


def covered(figures, pages):
    """Each picture and table of docs/ is in the table once and on a page."""
    there = [name for name in tracked(*KINDS)]
    listed = [file for figure in figures for file in figure['files']]
    problems = [f'{name}: not in tests/docs/figures.toml; add the command that makes it' for name in there if name not in listed]
    problems += [f'figures.toml: there is no {name}' for name in listed if name not in there]
    problems += [f'figures.toml: {name} is listed twice' for name in sorted(set(listed)) if listed.count(name) > 1]
    shown = {os.path.normpath(os.path.join(os.path.dirname(page.name), target)) for page in pages for _, target, picture in page.links() if picture}
    return problems + [f'{name}: no page shows it' for name in there if name not in shown and not name.endswith('.csv')]


def stale(figures, runner):
    """Long figures whose inputs have changed, or whose command is not accepted."""
    problems = []
    for figure in figures:
        command = figure['command']
        if figure['cost'] not in ('quick', 'long'):
            problems.append(f'figures.toml: {command}: cost is quick or long')
        if figure['cost'] != 'long':
            continue
        if command.startswith('cophase'):
            status, said = runner.parse(command, ROOT)
            problems += [] if status == 0 else [f'figures.toml: {command}: {said.strip()[:300]}']
        else:
            problems += [f'figures.toml: {command}: {problem}' for problem in cargo.check(command)]
        if not figure.get('undetected'):
            problems.append(f'figures.toml: {command}: say in `undetected` which changes the hash cannot see')
        if 'elsewhere' in figure:
            if figure['elsewhere'] not in (ROOT / '.ci/run').read_text():
                problems.append(f'figures.toml: {command}: .ci/run has no {figure["elsewhere"]}')
            continue
        found, names = digest(figure['inputs'])
        if not names:
            problems.append(f'figures.toml: {command}: no file matches its inputs')
        elif found != figure['hash']:
            problems.append(f'{", ".join(figure["files"])}: inputs have changed since it was made; run `{command}`, '
                            f'then `tests/docs/check --stamp {figure["files"][0]}`')
    return problems


def remake(figures, runner, echo=print):
    """Quick figures that differ from what their command makes."""
    problems = []
    for figure in figures:
        if figure['cost'] != 'quick':
            continue
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, 'docs/machines').mkdir(parents=True)
            status, said = runner.shell(figure['command'], folder)
            if status != figure.get('status', 0):
                problems.append(f'figures.toml: `{figure["command"]}` ended with status {status}: {said.strip()[-300:]}')
                continue
            for file in figure['files']:
                made = pathlib.Path(folder, figure.get('from', file))
                if not made.exists() or made.read_bytes() != (ROOT / file).read_bytes():
                    problems.append(f'{file}: differs from what `{figure["command"]}` makes; make it again, or find out why it changed')
        echo(f'made again: {", ".join(figure["files"])}')
    return problems


def stamp(files):
    """Stores the hashes of long figures that have been made again."""
    text = TABLE.read_text()
    for file in files:
        figure = next((f for f in table() if file in f['files'] and 'hash' in f), None)
        if figure is None:
            return [f'{file}: not in figures.toml, or without a hash']
        found, _ = digest(figure['inputs'])
        before, command, after = text.partition(f"command = '{figure['command']}'")
        text = before + command + after.replace(f'hash = "{figure["hash"]}"', f'hash = "{found}"', 1)
    TABLE.write_text(text)
    return []
