"""Commands that are not executed: whether packages, targets, tests, scripts and variables that they name are there."""
import functools
import re
import shlex
import tomllib

from pages import ROOT, tracked

SUBCOMMANDS = ('bench', 'build', 'clippy', 'doc', 'fmt', 'install', 'run', 'test')


@functools.cache
def packages():
    """Folder and manifest of each package of the workspace."""
    found = {}
    for name in tracked('Cargo.toml', '*/Cargo.toml'):
        manifest = tomllib.loads((ROOT / name).read_text())
        if 'package' in manifest:
            found[manifest['package']['name']] = ((ROOT / name).parent, manifest)
    return found


@functools.cache
def workspace():
    return tomllib.loads((ROOT / 'Cargo.toml').read_text())['workspace']


def runs_in_ci(test, ci):
    """True if CI runs a test's file: one of a default member, of a package that `.ci/run` names, or one that npm runs."""
    path = (ROOT / test).resolve()
    owners = [(folder, name) for name, (folder, _) in packages().items() if path.is_relative_to(folder)]
    if path.suffix == '.rs' and owners:
        folder, name = max(owners, key=lambda pair: len(pair[0].parts))
        member = str(folder.relative_to(ROOT))
        return member in workspace()['default-members'] or f'--package {name}' in ci
    folder = str(path.parent.relative_to(ROOT))
    return folder in ci or folder.removesuffix('/test') in ci


def not_in_ci(line):
    """Packages of a `cargo test` that CI does not test."""
    ci = (ROOT / '.ci/run').read_text()
    for name in re.findall(r'(?:-p|--package) (\S+)', line):
        folder = packages().get(name, (ROOT, {}))[0]
        if str(folder.relative_to(ROOT)) not in workspace()['default-members'] and f'--package {name}' not in ci:
            yield f'.ci/run does not test {name}'


def target(folder, manifest, kind, name):
    """Source of a test or benchmark, or None."""
    for entry in manifest.get(kind, []):
        if entry['name'] == name and 'path' in entry:
            return folder / entry['path']
    inside = folder / {'test': 'tests', 'bench': 'benches'}[kind]
    return next((path for path in (inside / f'{name}.rs', inside / name / 'main.rs') if path.exists()), None)


def sources(root):
    """A target's source with the modules in the folder beside it."""
    yield root
    beside = root.parent if root.name in ('main.rs', 'lib.rs', 'mod.rs') else root.with_suffix('')
    yield from sorted(beside.rglob('*.rs')) if beside.is_dir() else ()


def check_test(words, kind):
    """`cargo test` or `cargo bench`: its packages, targets and the names that it filters by."""
    options, names, filters = [], {'-p': [], f'--{kind}': [], '--features': []}, []
    before, _, behind = ' '.join(words).partition(' -- ')
    words = iter(before.removesuffix(' --').split())
    for word in words:
        word = {'--package': '-p'}.get(word, word)
        if word in names:
            names[word].append(next(words, ''))
        elif word in ('--lib', '--release', '--locked', '--all'):
            options.append(word)
        elif word.startswith('-'):
            yield f'{word} is no option that is known here; correct it, or add it to tests/docs/cargo.py'
        else:
            filters.append(word)
    for package in names['-p']:
        if package not in packages():
            yield f'there is no package {package}'
            return
    chosen = {name: packages()[name] for name in names['-p']} or packages()
    for feature in names['--features']:
        if not any(feature in manifest.get('features', {}) for _, manifest in chosen.values()):
            yield f'{", ".join(chosen)} has no feature {feature}'
    roots = []
    for name in names[f'--{kind}']:
        found = [target(folder, manifest, kind, name) for folder, manifest in chosen.values()]
        roots += filter(None, found)
        if not any(found):
            yield f'there is no {kind} {name} in {", ".join(chosen)}'
    if not names[f'--{kind}']:
        roots = [path for folder, _ in chosen.values() for path in (folder / 'src').rglob('*.rs')]
        if '--lib' not in options:
            roots += [path for folder, _ in chosen.values() for path in (folder / 'tests').rglob('*.rs')]
            roots += [folder / test['path'] for folder, manifest in chosen.values() for test in manifest.get('test', []) if 'path' in test]
    files = {path for root in roots for path in sources(root)}
    for name in filters:
        # A filter is part of module::function. Files are modules.
        function = name.rsplit('::', 1)[-1]
        named = re.compile(rf'\b(?:fn|mod) \w*{re.escape(function)}|^ +\w*{re.escape(function)}\w*[,;:]', re.M)  # or in a macro's list
        if not any(function in path.stem or function in path.parts or named.search(path.read_text()) for path in files):
            yield f'no test of {", ".join(chosen)} has {name} in its name'


def check_script(program, arguments):
    """A script of the repository: it is executable, and knows the names that it is given."""
    path = ROOT / program
    if not path.is_file():
        yield f'there is no {program}'
        return
    around = [path, *(p for p in path.parent.iterdir() if p.suffix in ('.mjs', '.py'))]
    text = '\n'.join(p.read_text() for p in around if p.is_file())
    for argument in arguments:
        is_file = argument.endswith('.toml') or any(path.parent.glob(f'*/{argument}.*'))
        if not (is_file or re.search(rf'(?<![\w-]){re.escape(argument)}(?![\w-])', text)):
            yield f'{program} does not know {argument}'


def check(line):
    """Problems of a command that is not executed."""
    problems, folder = [], ROOT
    for part in line.split(' && '):
        words = shlex.split(part)
        while words and re.match(r'[A-Z_]+=', words[0]):
            variable = words.pop(0).split('=')[0]
            if variable.startswith('COPHASE_') and not any(variable in (ROOT / name).read_text(errors='ignore') for name in _sources()):
                problems.append(f'nothing reads {variable}')
        if not words:
            continue
        program, *rest = words
        if program == 'cd':
            folder = ROOT / rest[0]
            problems += [] if folder.is_dir() else [f'there is no folder {rest[0]}']
        elif program == 'cargo':
            aliases = tomllib.loads((ROOT / '.cargo/config.toml').read_text())['alias']
            if rest[0] in ('test', 'bench'):
                problems += check_test(rest[1:], rest[0])
            elif rest[0] not in aliases and rest[0] not in SUBCOMMANDS:
                problems.append(f'cargo has no {rest[0]}')
            elif rest[0] in aliases and rest[1:]:
                problems.append(f'cargo {rest[0]} takes no arguments')
            problems += [f'there is no package {name}' for flag, name in zip(rest, rest[1:]) if flag in ('-p', '--package') and name not in packages()]
            problems += [f'there is no folder {name}' for flag, name in zip(rest, rest[1:]) if flag == '--path' and not (ROOT / name).is_dir()]
        elif program == 'npm':
            scripts = (folder / 'package.json').read_text() if (folder / 'package.json').is_file() else ''
            problems += [] if rest[0] in ('ci',) or f'"{rest[0]}"' in scripts else [f'there is no npm script {rest[0]} in {folder}']
        elif program in ('node', 'python3') and not rest[0].startswith('-'):
            problems += check_script(str((folder / rest[0]).relative_to(ROOT)), rest[1:])
        elif re.match(r'(tests|host-sim|\.ci)/', program):
            problems += check_script(program, rest)
    return problems


@functools.cache
def _sources():
    return tracked('*.rs', '*.mjs', '*.py', '*.toml', 'tests/*/run', '.ci/run')
