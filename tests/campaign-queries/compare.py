"""Compare the queries of a campaign with the table and the sentences that `cophase campaign` writes.

Both count the same rows by programs of their own. The cases are some of seed 1 in which names were wrong, so that no
column is the same throughout. A changed row must then be found.
"""
import csv
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools/campaign-queries'))
import interval  # noqa: E402
import queries  # noqa: E402

CASES = ('7620', '7860')


def campaign(cophase, folder):
    """The rows of these cases as a file, and the table."""
    done = subprocess.run([cophase, 'campaign', '--seed', '1', '--runs', '10000', '--from', CASES[0], '--to', CASES[1], '--out', folder, '--quiet'])
    assert done.returncode in (0, 1), f'cophase campaign ended with status {done.returncode}'
    return folder / f'campaign-{CASES[0]}-{CASES[1]}.csv', (folder / 'campaign-table.md').read_text()


def answers(file, folder):
    """Rows of each query by its name; those by kind as a dictionary of (kind, seen by)."""
    connection = queries.connect([file], folder / 'campaign.parquet')
    found = {query.stem: queries.rows(connection, query) for query in queries.queries()}

    def key(row):
        return row['kind'] or 'all', '' if row['kind'] is None else 'encoder' if row['encoder'] else 'index'
    return {name: {key(row): row for row in of} if of and 'encoder' in of[0] and 'number' not in of[0] else of for name, of in found.items()}


def number(value, form='.2f', scale=1):
    return '' if value is None else f'{value * scale:{form}}'


def percent(value):
    return '' if value is None else f'{number(value, scale=100)} %'


def table_lines(found):
    """Lines of the table, by kind and sensor, as the queries have them."""
    detected, latency, named, tilt = (found[name] for name in ('1-detected-in-time', '1-latency', '2-rightly-named', '3-tilt'))
    return {at: [str(detected[at]['runs']), str(detected[at]['beyond_limit']), str(detected[at]['detected']),
                 *(number(latency[at][part]) for part in ('half', 'of_95', 'of_99', 'all_of_them')),
                 percent(named[at]['rate']), percent(named[at]['at_least']),
                 *(number(tilt[at][over]) for over in ('tilt_over_limit', 'tilt_over_bound', 'off_over_limit'))]
            for at in detected}


def sentences(found):
    """The sentences below the table, as the queries have them."""
    def rate(row, hits, of):
        ends = (number(row[end] or 0 if end == 'at_least' else 1 if row[end] is None else row[end], '.3f', 100) for end in ('at_least', 'at_most'))
        return f'{row[hits]} of {row[of]}', f'the rate is {" to ".join(ends)} % (95 %)'
    every = ('all', '')
    (trips,) = found['5-false-trips']
    for name, row, hits, of, more in (
            ('False trips', trips, 'false_trips', 'clean_runs', ' clean runs'),
            ('Detected in time', found['1-detected-in-time'][every], 'detected', 'counted', ' in which a crank passed its limit'),
            ('Rightly named', found['2-rightly-named'][every], 'named', 'counted', ''),
            ('Left running', found['4-left-running'][every], 'were_left', 'runs', '')):
        counts, bounds = rate(row, hits, of)
        yield f'{name}: {counts}{more}; {bounds}.'


def single_cases(text):
    """Cases that the table lists below its sentences."""
    return sorted({int(case) for cases in re.findall(r': \d+ \(([\d, ]+)\)$', text, re.M) for case in cases.split(', ')})


def compare(found, text):
    """Where queries and the text of campaign-table.md differ."""
    written = {}
    for line in re.findall(r'^\| (.*) \|$', text, re.M)[2:]:
        kind, sensor, *cells = (cell.strip() for cell in line.split('|'))
        written[kind, sensor] = cells
    ours = table_lines(found)
    problems = [f'{at}: the table has {written.get(at)}, the queries {ours.get(at)}' for at in written.keys() | ours.keys()
                if written.get(at) != ours.get(at)]
    problems += [f'not in the table: {sentence}' for sentence in sentences(found) if sentence not in text.splitlines()]
    for name, says in (('beyond_bound', 'tilted beyond its bound'), ('after_stop', 'tilted after its stop')):
        count = found['3-tilt']['all', ''][name]
        if (count > 0) != (says in text):
            problems.append(f'{count} {says}, and the table says otherwise')
    cases = sorted({row['number'] for row in found['6-not-as-claimed']})
    if cases != single_cases(text):
        problems.append(f'single cases: the table has {single_cases(text)}, the queries {cases}')
    return problems


def changed(file, folder, choose, change):
    """A copy of a campaign.csv with its first row that `choose` takes changed."""
    rows = list(csv.DictReader(file.read_text().splitlines()))
    row = next(row for row in rows if choose(row))
    row.update(change(row))
    copy = folder / 'changed.csv'
    with open(copy, 'w', newline='') as out:
        writer = csv.DictWriter(out, rows[0], lineterminator='\n')
        writer.writeheader()
        writer.writerows(rows)
    return copy


def self_test(file, text, folder):
    """Changes of one row that each claim's query must show."""
    for name, choose, change in (
            ('in time', lambda row: row['in_time'] == 'true', lambda row: {'in_time': 'false'}),
            ('latency', lambda row: row['turns_from_limit'], lambda row: {'turns_from_limit': '2.5'}),
            ('name', lambda row: row['verdict'] == 'right', lambda row: {'verdict': 'misnamed'}),
            ('tilt', lambda row: row['kind'], lambda row: {'tilt_mrad': str(10 * float(row['bound_mrad']))}),
            ('tilt, drives off', lambda row: row['tilt_off_mrad'], lambda row: {'tilt_off_mrad': '1e6'}),
            ('tilt after a stop', lambda row: row['kind'] and row['hold_bound_mrad'], lambda row: {'tilt_hold_mrad': '1e6'}),
            ('left running', lambda row: row['kind'], lambda row: {'left_running': 'true'}),
            ('false trip', lambda row: row['clean'] == 'true', lambda row: {'verdict': 'false-trip'})):
        assert compare(answers(changed(file, folder, choose, change), folder), text), f'a changed row was not found: {name}'


def refusals(file, folder):
    """Input that must be refused, and part of the reason."""
    text = file.read_text()

    def having(**cells):
        """The rows with other cells in the columns that say what they are of."""
        rows = list(csv.DictReader(text.splitlines()))
        written = io.StringIO()
        writer = csv.DictWriter(written, rows[0], lineterminator='\n')
        writer.writeheader()
        writer.writerows(row | cells for row in rows)
        return written.getvalue()
    seed_2 = having(seed='2')
    other = folder / 'other.csv'
    for wrong, reason in (('\n'.join(seed_2.splitlines()[:-1]) + '\n', 'run that range again'), (text.replace('seed', 'need', 1), 'first row'),
                          (text, 'leave one out'), (having(seed='2', plan='99'), 'query them apart'),
                          (having(seed='2', only='slip:index@1/45'), '--only'), (seed_2.replace(',false,', ',perhaps,', 1), 'perhaps')):
        other.write_text(wrong)
        try:
            queries.connect([file, other], folder / 'campaign.parquet')
        except queries.Refused as error:
            assert reason in str(error), (reason, str(error))
        else:
            raise AssertionError(f'not refused: {reason}')
    other.write_text(seed_2)
    connection = queries.connect([file, other], folder / 'campaign.parquet')
    (rows,) = connection.execute('SELECT count(*) FROM campaign').fetchone()
    assert rows == 2 * (len(text.splitlines()) - 1), rows


def check_interval():
    """At the ends the tails of the binomial are 2.5 %, summed term by term; and the closed form where there are no hits."""
    from math import comb
    for hits, of in ((1, 8), (37, 100), (3, 500)):
        low, high = interval.lower(hits, of), interval.upper(hits, of)
        at_most = [sum(comb(of, k) * rate**k * (1 - rate) ** (of - k) for k in range(upto + 1)) for rate, upto in ((low, hits - 1), (high, hits))]
        assert abs(1 - at_most[0] - 0.025) < 1e-9 and abs(at_most[1] - 0.025) < 1e-9, (hits, of, at_most)
    for bound in (1e-2, 1e-5):
        runs = interval.runs_for(bound)
        assert 1 - 0.025 ** (1 / runs) <= bound < 1 - 0.025 ** (1 / (runs - 1)), runs


def check_page():
    """Problems of what the page quotes from `rate`."""
    page = (ROOT / 'docs/recipes/run-a-campaign-on-a-cluster.md').read_text()
    quoted = re.findall(r'^    \$ (tools/campaign-queries/rate .*)\n((?:    .*\n)+)', page, re.M)
    problems = [] if len(quoted) == 2 else [f'the page has {len(quoted)} sessions of rate, not 2']
    for command, output in quoted:
        said = subprocess.run([sys.executable, *command.split()], cwd=ROOT, text=True, capture_output=True).stdout
        if said != re.sub('^    ', '', output, flags=re.M):
            problems.append(f'`{command}` does not print what the page has, but:\n{said}')
    return problems


def main():
    cophase = os.path.realpath(os.environ.get('COPHASE', ROOT / 'target/release/cophase'))
    check_interval()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        file, text = campaign(cophase, folder)
        problems = compare(answers(file, folder), text) + check_page()
        for problem in problems:
            print(problem)
        if not single_cases(text):
            problems.append('no single case')
            print('these cases are all as claimed; give others in CASES')
        if not problems:
            self_test(file, text, folder)
            refusals(file, folder)
            print(f'queries and table agree in {text.count(chr(10) + "| ") - 2} rows; cases that are not as claimed, or misnamed: {single_cases(text)}')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main())
