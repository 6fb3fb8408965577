"""Commands that the pages quote: found, matched with the rules of commands.toml, and run, or checked without running.

A rule says what becomes of the commands that its `pattern` matches wholly, `cargo sim` written as `cophase`:

    run     executed, with `as` in its place if given; it must end with `status` (0)
    parse   not executed, as `reason` says; `cophase` must accept its arguments
    ci      the same, and CI runs it: `.ci/run` has the command, or `where`, or `where` is a test's file that has `says`
    board   the same, and it needs a board
    long    the same, and it takes long
    mention no command of itself, but its name, or a form with placeholders

A page's commands are executed in order, in an empty folder with the default scene as my.toml. `edit` changes a file there before
the command: what a reader does by hand; the page must have the new lines. `nth` is a rule for the n-th of equal commands. What follows a command in a `console` block must be printed by it; `…` stands for what is
left out.
"""
import fnmatch
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import tomllib

import cargo
from pages import ROOT, tracked

TABLE = ROOT / 'tests/docs/commands.toml'
PATH = r'(?:tests|host-sim|firmware|docs|\.ci)/'
COMMAND = re.compile(rf'(?:cophase|cargo|node|python3|rustup|npm|cd|target/\S+|sed|grep|sigrok-cli|probe-rs|gtkwave|pulseview|plotjuggler) |(?:COPHASE|PROPTEST)_\w+=|{PATH}|\.ci/run')
CODE_LANGUAGES = ('', 'sh', 'bash', 'console')
SECONDS = 120
HOWS = ('run', 'parse', 'ci', 'board', 'long', 'mention')


class Quoted:
    """A command as a page quotes it."""

    def __init__(self, page, position, text, output=None):
        self.page, self.where = page, f'{page.name}:{page.line(position)}'
        self.written = text
        self.text = re.sub(r'^cargo sim(?= |$)', 'cophase', text)
        self.output = output
        self.nth = 1  # how many times the page has had this command so far


def quoted(page):
    """Commands of a page in the order of its text, and problems of the paths that it names."""
    found, problems = [], []
    for start, _, language, lines in page.code:
        if language not in CODE_LANGUAGES:
            continue
        current, joined, at = None, '', 0
        for position, line in lines:
            if language == 'console':
                if line.startswith('$ '):
                    current = Quoted(page, position, _plain(line[2:]), [])
                    found.append((position, current))
                elif current:
                    current.output.append(line)
                continue
            line = line.removeprefix('$ ')
            joined, at = (joined + line, at) if joined else (line, position)
            if joined.endswith('\\'):
                joined = joined[:-1]
                continue
            line, joined = _plain(joined), ''
            if COMMAND.match(line) and not _is_path(line.split(' ')[0], line):
                found.append((at, Quoted(page, at, line)))
    for position, text in page.spans():
        if re.fullmatch(rf'{PATH}\S*', text) and not _is_program(text):
            if not _exists(re.sub(r'/[A-Z]+\.\w+$', '', text)):  # NAME.rs is a placeholder
                problems.append(f'{page.name}:{page.line(position)}: there is no {text}; correct the path')
        elif COMMAND.match(text):
            found.append((position, Quoted(page, position, text)))
    ordered = [command for _, command in sorted(found, key=lambda pair: pair[0])]
    for i, command in enumerate(ordered):
        command.nth = 1 + sum(before.text == command.text for before in ordered[:i])
    return ordered, problems


def _plain(line):
    return re.sub(r'\s+#\s.*$', '', line).strip()


def _is_program(path):
    return (ROOT / path).is_file() and os.access(ROOT / path, os.X_OK)


def _is_path(word, line):
    """True if a line begins with a path that it explains, as in a list of folders."""
    return bool(re.match(PATH, word)) and not _is_program(word) and (ROOT / word).exists() and '  ' in line


def _exists(path):
    path = path.rstrip('/')
    return bool((ROOT / path).exists() or any(f'/{name}'.endswith(f'/{path}') for name in _names()))


def _names(found=[]):  # the list is read once
    found = found or found.extend(tracked()) or found
    return found


class Rules:
    def __init__(self, table=None):
        table = tomllib.loads(TABLE.read_text()) if table is None else table
        self.rules, self.problems = table['rule'], []
        for rule in self.rules:
            rule['used'] = False
            if rule['how'] not in HOWS or rule['how'] != 'run' and not rule.get('reason'):
                self.problems.append(f'commands.toml: {rule["pattern"]}: give how (one of {", ".join(HOWS)}) and, unless it is run, a reason')
            if rule['how'] == 'ci' and 'where' in rule and not in_ci(rule):
                self.problems.append(f'commands.toml: {rule["pattern"]}: CI does not run {rule.get("where")}; correct `where` or `says`')

    def find(self, command):
        """The rule for a command, and the command to execute."""
        for rule in self.rules:
            if not fnmatch.fnmatch(command.page.name, rule.get('page', '*')):
                continue
            found = re.fullmatch(rule['pattern'], command.text)
            if found and rule.get('nth', command.nth) == command.nth:
                rule['used'] = True
                return rule, found.expand(rule['as']) if 'as' in rule else command.text
        return None, command.text

    def unused(self):
        return [f'commands.toml: {rule["pattern"]}: no page has such a command; remove the rule' for rule in self.rules if not rule['used']]


def in_ci(rule):
    ci = (ROOT / '.ci/run').read_text()
    where = rule['where']
    if (ROOT / where).is_file() and 'says' in rule:
        return rule['says'] in (ROOT / where).read_text() and cargo.runs_in_ci(where, ci)
    return where in ci


class Runner:
    """Executes a page's commands in a folder of their own."""

    def __init__(self, cophase):
        self.tools = tempfile.TemporaryDirectory()
        os.symlink(pathlib.Path(cophase).resolve(), pathlib.Path(self.tools.name, 'cophase'))
        self.environment = {**os.environ, 'PATH': f'{self.tools.name}:{os.environ["PATH"]}'}
        self.environment.pop('COPHASE', None)
        self.parsed = {}

    def shell(self, line, folder):
        try:
            done = subprocess.run(['bash', '-c', line], cwd=folder, env=self.environment, text=True, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=SECONDS)
            return done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            return None, f'not done after {SECONDS} s'

    def parse(self, line, folder):
        """Checks that `cophase` accepts the arguments. A missing argument is not found, because its help does not check that."""
        line = re.sub(r'\s*[<>|].*$', '', line)
        if line not in self.parsed:
            self.parsed[line] = self.shell(f'{line} --help', folder)
        return self.parsed[line]

    def check(self, page, commands, rules):
        problems, done = [], set()
        with tempfile.TemporaryDirectory() as folder:
            self.shell('cophase scenes default > my.toml', folder)
            for command in commands:
                rule, line = rules.find(command)
                if rule is None:
                    problems.append(f'{command.where}: no rule of tests/docs/commands.toml covers `{command.written}`; add one, or correct the command')
                    continue
                if command.output is None and line in done:
                    continue
                done.add(line)
                problems += self._one(command, rule, line, folder)
        return problems

    def _one(self, command, rule, line, folder):
        if rule['how'] == 'run':
            for edit in rule.get('edit', []):
                missing = [part for part in edit['new'].splitlines() if part not in edit['old'] and part.strip() not in command.page.text]
                if missing:
                    return [f'{command.where}: commands.toml edits what the page does not have: {missing[0]}']
                path = pathlib.Path(folder, edit['file'])
                text = path.read_text()
                if text.count(edit['old']) != 1:
                    return [f'{command.where}: commands.toml: {edit["old"]!r} is not once in {edit["file"]}; correct the edit']
                path.write_text(text.replace(edit['old'], edit['new']))
            status, said = self.shell(line, folder)
            expected = rule.get('status', 0)
            if status != expected:
                return [f'{command.where}: `{command.written}` ended with status {status}, not {expected}: {said.strip()[-300:]}']
            return self._compare(command, said)
        if rule['how'] == 'ci' and 'where' not in rule and not re.search(rf'^{re.escape(line)}$', (ROOT / '.ci/run').read_text(), re.M):
            return [f'{command.where}: .ci/run has no line `{line}`; correct the rule or the command']
        if line.startswith('cophase'):
            status, said = self.parse(line, folder)
            return [] if status == 0 else [f'{command.where}: `{command.written}`: {said.strip()[:300]}']
        problems = cargo.check(line)
        if rule['how'] == 'ci' and 'cargo test' in line:
            problems += cargo.not_in_ci(line)
        return [f'{command.where}: `{command.written}`: {problem}' for problem in problems]

    @staticmethod
    def _compare(command, said):
        """The quoted output must be printed, in its order."""
        rest = said.splitlines()
        for line in filter(lambda line: line not in ('', '…'), command.output or []):
            pattern = '.*'.join(re.escape(part) for part in re.split(r' ?… ?', line))
            at = next((i for i, printed in enumerate(rest) if re.fullmatch(pattern, printed.strip())), None)
            if at is None:
                return [f'{command.where}: `{command.written}` does not print, or not in this order: {line}']
            rest = rest[at + 1:]
        return []


def check(pages, cophase, rules=None):
    """Problems of all commands, and how many there are of each kind."""
    rules = rules or Rules()
    runner, problems, counts = Runner(cophase), list(rules.problems), dict.fromkeys(HOWS, 0)
    for page in pages:
        commands, bad_paths = quoted(page)
        problems += bad_paths + runner.check(page, commands, rules)
        for command in commands:
            rule, _ = rules.find(command)
            if rule:
                counts[rule['how']] += 1
    return problems + rules.unused(), counts
