"""Sentences of all pages, and the table of causes in campaign.md."""
import collections
import csv
import math
import re

import pages
from prose import sentences

LONGEST = 40
MEAN = 20


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
