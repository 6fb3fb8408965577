"""Sentences of all pages, and the rows that the code requires of troubleshooting.md."""
import re

import pages
from prose import sentences

LONGEST = 40
MEAN = 20
FAULTS = 'firmware/core/src/supervisor/fault.rs'
REFUSALS = [
    ('firmware/link/src/message.rs', 'Refusal'),
    ('firmware/link/src/error.rs', 'SettingsFileError'),
    ('firmware/link/src/board/mod.rs', 'Unfit'),
    ('host-sim/command/src/scope/access.rs', 'Denied'),
]


def check_sentences(paths, echo=print):
    problems, counts = [], []
    for path in paths:
        own = []
        for line, count, sentence in sentences(path):
            own.append(count)
            if count > LONGEST:
                problems.append(f'{path.relative_to(pages.ROOT) if path.is_relative_to(pages.ROOT) else path}:{line}: a sentence of {count} words; '
                                f'{LONGEST} are the most: {sentence[:80]}…')
        if own and sum(own) / len(own) > MEAN:
            problems.append(f'{path.name}: sentences have {sum(own) / len(own):.1f} words on average; {MEAN} are the most')
        counts += own
    echo(f'{len(counts)} sentences, {sum(counts) / max(1, len(counts)):.1f} words on average, {max(counts, default=0)} in the longest')
    return problems


def check_fault_names(text):
    """Each fault of the core has its row in the table of troubleshooting.md."""
    names = re.findall(r'Self::\w+ => "([a-z-]+)"', (pages.ROOT / FAULTS).read_text())
    assert len(names) > 20, f'{FAULTS} has no names any more where this check looks for them'
    return [f'docs/troubleshooting.md: no row for the fault `{name}`' for name in names if not re.search(rf'^\| `{name}`', text, re.M)]


def check_refusals(text):
    """Each refusal of the host link and of the board has its row, too: a piece of its message."""
    problems = []
    for file, name in REFUSALS:
        source = (pages.ROOT / file).read_text()
        begin = source.index(f' enum {name} ')
        messages = re.findall(r'#\[error\(\s*"((?:\\.|[^"\\])+)"', source[begin:source.index('\n}', begin)], re.S)
        assert messages, f'{file} has no {name} with messages any more'
        for message in messages:
            pieces = [piece.strip() for piece in re.split(r'\{[^{}]*\}|[;:,]', message)]
            if not any(len(piece) >= 10 and piece in text for piece in pieces):
                problems.append(f'docs/troubleshooting.md: no row for the refusal "{message}" of {file}')
    return problems


def check_sayings(text):
    """What the tables quote as said is said somewhere in the sources."""
    sources = '\n'.join((pages.ROOT / name).read_text() for name in pages.tracked('host-sim/*.rs', 'firmware/*.rs'))
    sources = re.sub(r'\\\n\s*', '', sources)  # a string goes on behind a backslash
    problems, says = [], False
    for line in text.splitlines():
        says = line.startswith('| it says') or says and line.startswith('|')
        for quoted in re.findall(r'`([^`]+)`', line.split('|')[1]) if says else ():
            problems += [f'docs/troubleshooting.md: nothing says "{part.strip()}" any more' for part in quoted.split('…') if part.strip() not in sources]
    return problems
