"""Mistakes that the check must find, each beside the same page without it."""
import pathlib
import tempfile

import commands
import figures
import links
import pages
from texts import check_causes, check_fault_names, check_led, check_sayings, check_sentences

LONG = 'A sentence of this kind ' + 'goes on and on ' * 12 + 'and has no end.'


def page(text):
    return pages.Page('docs/made-up.md', text)


def sentence_problems(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, 'made-up.md')
        path.write_text(text)
        return check_sentences([path], echo=lambda said: None)


def command_problems(cophase):
    def find(text):
        rules = commands.Rules()
        problems = list(rules.problems)
        quoted, paths = commands.quoted(page(text))
        return problems + paths + commands.Runner(cophase).check(page(text), quoted, rules)
    return find


def figure_problems(cophase):
    def find(command):
        made = {'files': ['docs/machines/screen-drawing.svg'], 'command': command, 'cost': 'quick'}
        return figures.remake([made], commands.Runner(cophase), echo=lambda said: None)
    return find


def hash_problems(cophase):
    def find(value):
        figure = {'files': ['docs/x.svg'], 'command': 'cophase campaign', 'cost': 'long', 'inputs': ['LICENSE-MIT'], 'hash': value, 'undetected': '-'}
        return figures.stale([figure], commands.Runner(cophase))
    return find


def figure_rows(table):
    return figures.covered(table, pages.pages())


def summary_problems(text):
    others = [p for p in pages.pages() if p.name != 'docs/SUMMARY.md']
    return links.check_summary([*others, pages.Page('docs/SUMMARY.md', text)])


def book_problems(target):
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, 'a.html').write_text(f'<a href="{target}">b</a>')
        pathlib.Path(folder, 'b.html').write_text('<h1 id="there">There</h1>')
        return links.check_book(folder)


def cases(cophase):
    """Tests of the checks: for each, the check, a correct input, and an incorrect one."""
    link_problems = lambda text: links.check([page(text)])[0]
    run, draw, stale = command_problems(cophase), figure_problems(cophase), hash_problems(cophase)
    troubleshooting = (pages.ROOT / 'docs/troubleshooting.md').read_text()
    console = '```console\n$ cophase scenes\n{}\n```\n'
    yield 'a long sentence', sentence_problems, 'A short sentence.', LONG
    yield 'a broken link', link_problems, '[a](wiring.md)', '[a](wirings.md)'
    yield 'a broken anchor', link_problems, '[a](wiring.md#levels)', '[a](wiring.md#level)'
    yield 'a missing picture', link_problems, '![a](methods.svg)', '![a](method.svg)'
    yield 'an anchor on the page', link_problems, '# Two words\n\n[a](#two-words)', '# Two words\n\n[a](#two)'
    yield 'an unknown command', run, '    cophase scenes\n', '    cophase scene\n'
    yield 'an unknown flag', run, 'Use `cophase run lost-steps`.', 'Use `cophase run lost-steps --fast`.'
    yield 'a command that fails', run, '    cophase scenes default\n', '    cophase scenes defualt\n'
    yield 'a status that differs', run, '    cophase run default\n', '    cophase run nowhere.toml\n'
    yield 'a wrong number', run, '    cophase design --load-kg 25 --amax-g 80 --freq-hz 25 --lambda 0.3 --motors 4\n', \
        '    cophase design --load-kg 25 --amax-g 80 --freq-hz 25 --lambda 3 --motors 4\n'
    yield 'a flag of a command for a board', run, '    cophase link record --out my-run --start\n', '    cophase link record --out my-run --begin\n'
    yield 'output that is not printed', run, console.format('slider-crank'), console.format('slider-clank')
    yield 'a test that is not there', run, '`cargo test -p cophase-files --test fidelity`', '`cargo test -p cophase-files --test fidelities`'
    yield 'a test that CI does not run', run, '`cargo test -p cophase-fuzz`', '`cargo test -p cophase-functions`'
    yield 'a package that is not there', run, '`cargo test -p cophase-core`', '`cargo test -p cophase-cor`'
    yield 'a test name that matches none', run, '`cargo test -p cophase-core axes`', '`cargo test -p cophase-core axles_of_none`'
    yield 'a scenario that is not there', run, '`tests/emulator/run parity`', '`tests/emulator/run purity`'
    yield 'a path that is not there', run, '`tests/phases.rs`', '`tests/phrases.rs`'
    yield 'a row without its fault', check_fault_names, troubleshooting, troubleshooting.replace('| `slip` |', '| `slips` |')
    yield 'a saying that nobody says', check_sayings, troubleshooting, troubleshooting.replace('`the machine is not armed`', '`the machine is unarmed`')
    yield 'an LED that blinks otherwise', check_led, troubleshooting, troubleshooting.replace('four times a second', 'twice a second')
    yield 'a state without its row of the LED', check_led, troubleshooting, troubleshooting.replace('homing, run, stop or parked', 'homing, run or stop')
    yield 'a row that the LED never shows', check_led, troubleshooting, troubleshooting.replace('| dark |', '| three flashes | idle | |\n| dark |')
    campaign = (pages.ROOT / 'docs/campaign.md').read_text()
    yield 'another share of a cause', check_causes, campaign, campaign.replace('`stuck` ', '`stuck` 1')
    drawing = 'cophase scenes {} --svg docs/machines/screen-drawing.svg'
    yield 'a figure that differs', draw, drawing.format('screen'), drawing.format('wrapper')
    listed = figures.table()
    yield 'a picture that no command makes', figure_rows, listed, [f for f in listed if 'docs/methods.svg' not in f['files']]
    summary = (pages.ROOT / 'docs/SUMMARY.md').read_text()
    yield 'a page that is in no table of contents', summary_problems, summary, summary.replace('(safety.md)', '(wiring.md)')
    yield 'a dead link of the book', book_problems, 'b.html#there', 'b.html#elsewhere'
    yield 'changed inputs', stale, figures.digest(['LICENSE-MIT'])[0], '0123456789abcdef'


def run(cophase):
    failed = 0
    for name, find, sound, mistaken in cases(cophase):
        before, found = find(sound), find(mistaken)
        passed = not before and found
        failed += not passed
        print(f'{"ok  " if passed else "FAIL"} {name}: {found[0][:120] if found else "not found"}')
        for problem in before:
            print(f'     the sound one has: {problem}')
    print(f'{failed} mistakes were not found' if failed else 'every mistake was found')
    return 1 if failed else 0
