"""Sentences of all pages, the rows that the code requires of troubleshooting.md, and the table of causes in campaign.md."""
import collections
import csv
import math
import re

import pages
from prose import sentences

LONGEST = 40
MEAN = 20
FAULTS = 'firmware/core/src/supervisor/fault.rs'
STATES = 'firmware/core/src/supervisor/mod.rs'
LED = 'firmware/src/board/lines.rs'
LED_REFUSED = 'firmware/src/start.rs'
TIMES = {1: 'once', 2: 'twice', 3: 'three times', 4: 'four times', 5: 'five times'}
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
            if message == '{}':
                continue  # A text of the controller, which its own row quotes.
            pieces = [piece.strip() for piece in re.split(r'\{[^{}]*\}|[;:,]', message)]
            if not any(len(piece) >= 10 and piece in text for piece in pieces):
                problems.append(f'docs/troubleshooting.md: no row for the refusal "{message}" of {file}')
    return problems


def check_sayings(text):
    """Checks that the sources contain the messages that the tables quote."""
    sources = '\n'.join((pages.ROOT / name).read_text() for name in pages.tracked('host-sim/*.rs', 'firmware/*.rs', 'host-sim/scope/page/*.js'))
    sources = re.sub(r'\\\n\s*', '', sources)  # a string continues after a backslash
    problems, says = [], False
    for line in text.splitlines():
        says = line.startswith('| it says') or says and line.startswith('|')
        for quoted in re.findall(r'`([^`]+)`', line.split('|')[1]) if says else ():
            problems += [f'docs/troubleshooting.md: nothing says "{part.strip()}" any more' for part in quoted.split('…') if part.strip() not in sources]
    return problems


def led_patterns():
    """Patterns of the firmware's LED. For each, the words that a row must have beside its meaning."""
    source = (pages.ROOT / LED).read_text()
    begin = source.index('pub fn led(')
    source = source[begin:source.index('\n}', begin)]
    arms = re.findall(r'State::(\w+)(?: if (\w+))? => \(now_us >> (\d+)\) & (\d+) (==|!=) 0', source)
    assert arms and '_ => true' in source, f'{LED} has no patterns of the LED any more where this check looks for them'
    for state, condition, shift, mask, sign in arms:
        part = 1 / (int(mask) + 1)
        on = part if sign == '==' else 1 - part
        period_s = (int(mask) + 1) * 2 ** int(shift) / 1e6
        shape = 'short flash' if on < 0.25 else 'short gap' if on >= 0.75 else 'even'
        held = ['hold'] if condition else []
        yield [shape, TIMES[round(1 / period_s)] + ' a second'], [state.lower(), *held]
    states = (pages.ROOT / STATES).read_text()
    begin = states.index('pub enum State {')
    names = re.findall(r'^    (\w+),$', states[begin:states.index('\n}', begin)], re.M)
    yield ['steady'], [name.lower() for name in names if name not in {arm[0] for arm in arms}]
    source = (pages.ROOT / LED_REFUSED).read_text()
    dark_ms = re.search(r'for dark_ms in \[([\d, ]+)\]', source)
    light_ms = re.search(r'light\(true\);\s*Timer::after\(Duration::from_millis\((\d+)\)\)', source)
    assert dark_ms and light_ms, f'{LED_REFUSED} does not flash the LED any more where this check looks for it'
    dark_ms = [int(ms) for ms in dark_ms[1].split(',')]
    period_s = (sum(dark_ms) + len(dark_ms) * int(light_ms[1])) / 1e3
    count = {1: 'a short flash', 2: 'two short flashes', 3: 'three short flashes'}[len(dark_ms)]
    yield [count, TIMES[round(1 / period_s)] + ' a second'], ['settings', 'refused']


def check_led(text):
    """Each pattern of the LED has its row, and each row of a pattern is one that the firmware shows."""
    table = re.search(r'^\| LED \|.*\n\|[- |]*\n((?:\|.*\n)+)', text, re.M)
    rows = [[cell.strip() for cell in line.split('|')[1:3]] for line in table[1].splitlines()] if table else []
    rows = [row for row in rows if not row[0].startswith('dark')]
    problems = []
    for shown, means in led_patterns():
        fitting = [row for row in rows if all(word in row[0] for word in shown) and all(word in row[1] for word in means)]
        rows = [row for row in rows if row not in fitting[:1]]
        if not fitting:
            problems.append(f'docs/troubleshooting.md: no row says that the LED shows "{", ".join(shown)}" for {", ".join(means)}')
    return problems + [f'docs/troubleshooting.md: the LED never shows "{shown}" for "{means}"' for shown, means in rows]


def cause_rows(counted):
    """Rows of the table of causes: names by one sensor with at least 50 runs, of which less than 98 % had one cause."""
    runs = {}
    for name, sensor, _, cause, count, _ in list(csv.reader(counted.splitlines()))[1:]:
        causes = runs.setdefault((name, sensor), collections.Counter())
        causes[cause] += int(count)
    for (name, sensor), causes in runs.items():
        if causes.total() >= 50 and max(causes.values()) < 0.98 * causes.total():
            shares = [(cause, math.floor(100 * count / causes.total() + 0.5)) for cause, count in causes.most_common()]
            listed = ', '.join(f'`{cause}` {share}' for cause, share in shares if share)
            yield f'| `{name}` | {sensor} | {causes.total():,} | {listed} |'


def check_causes(text):
    """The table of causes has the numbers of docs/causes.csv."""
    expected = list(cause_rows((pages.ROOT / 'docs/causes.csv').read_text()))
    table = re.search(r'^\| name \| seen by \| runs \| causes.*\n\|[- |:]*\n((?:\|.*\n)+)', text, re.M)
    rows = table[1].splitlines() if table else []
    return ([f'docs/campaign.md: the table of causes lacks "{row}"' for row in expected if row not in rows]
            + [f'docs/campaign.md: the table of causes has "{row}", which docs/causes.csv does not' for row in rows if row not in expected])
