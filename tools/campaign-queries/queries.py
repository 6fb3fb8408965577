"""Stores campaigns as Parquet, and answers one query per claim with DuckDB.

The queries are the .sql files beside this, in the order of their names. docs/campaign.md has the claims.
"""
import argparse
import csv
import pathlib
import re
import sys

import duckdb

import interval

HERE = pathlib.Path(__file__).resolve().parent


class Refused(Exception):
    """Bad input: place, problem, fix."""


def files_of(paths):
    """Files of paths, each a campaign.csv or a folder that has one."""
    for path in map(pathlib.Path, paths):
        file = path / 'campaign.csv' if path.is_dir() else path
        if not file.is_file():
            raise Refused(f'{file}: is not there; give a campaign.csv, or a folder that has one')
        yield file


def header(file):
    """What the rows of a file are of, as its first row states it."""
    with open(file, encoding='utf-8', errors='replace', newline='') as lines:
        first = next(csv.DictReader(lines), {})
    try:
        whole = {name: int(first[name]) for name in ('plan', 'seed', 'from', 'to')}
        words = {name: first[name] for name in ('version', 'commit', 'scene')}
        chosen = first['only']
    except (KeyError, TypeError, ValueError):
        raise Refused(f'{file}: its first row does not say what the rows are of; give a file that `cophase campaign` wrote') from None
    if chosen:
        raise Refused(f'{file}: has chosen strata alone (--only), and the queries count cases alike; give a campaign of all cases')
    return whole | words


def check_together(headers):
    """Refuses campaigns that are no sample of one population, and cases that would count twice."""
    first = headers[0]
    for at, (file, head) in enumerate(headers):
        for key in ('version', 'commit', 'plan', 'scene'):
            if head[key] != first[1][key]:
                raise Refused(f'{file}: {key} = {head[key]}, and {first[0]} has {first[1][key]}; query them apart')
        for other, earlier in headers[:at]:
            if head['seed'] == earlier['seed'] and head['from'] < earlier['to'] and earlier['from'] < head['to']:
                raise Refused(f'{file}: has cases of {other}; leave one out')


def connect(paths, parquet):
    """A connection with the rows of all files, read back from the Parquet file that this writes."""
    headers = [(file, header(file)) for file in files_of(paths)]
    check_together(headers)
    connection = duckdb.connect()
    connection.execute((HERE / 'sql/load.sql').read_text())
    for at, (file, head) in enumerate(headers):
        before = connection.execute('SELECT count(*) FROM loaded').fetchone()[0] if at else 0
        try:
            connection.execute(f'{"INSERT INTO loaded" if at else "CREATE TABLE loaded AS"} SELECT * FROM campaign_csv($file)', {'file': str(file)})
        except duckdb.Error as error:
            said = str(error)
            line, why = re.search(r'Line: (\d+)', said), re.search(r'Error when converting .*|Expected Number of Columns.*', said)
            raise Refused(f'{file}: {f"line {line[1]}: {why[0]}" if line and why else said.splitlines()[0]}; '
                          'give a file that `cophase campaign` wrote') from None
        read, expected = connection.execute('SELECT count(*) FROM loaded').fetchone()[0] - before, 2 * (head['to'] - head['from'])
        if read != expected:
            raise Refused(f'{file}: has {read} of the {expected} rows that its first row states; run that range again')
    connection.execute(f"COPY loaded TO '{quoted(parquet)}' (FORMAT parquet, COMPRESSION zstd)")
    connection.execute(f"CREATE VIEW campaign AS SELECT * FROM read_parquet('{quoted(parquet)}')")
    connection.create_function('lower_end', lambda hits, of: interval.lower(hits, of), ['BIGINT', 'BIGINT'], 'DOUBLE')
    connection.create_function('upper_end', lambda hits, of: interval.upper(hits, of), ['BIGINT', 'BIGINT'], 'DOUBLE')
    connection.execute((HERE / 'sql/views.sql').read_text())
    return connection


def quoted(path):
    return str(path).replace("'", "''")


def queries():
    return sorted((HERE / 'sql').glob('[0-9]-*.sql'))


def rows(connection, query):
    """Rows of a query, each as a dictionary."""
    done = connection.execute(query.read_text())
    names = [column[0] for column in done.description]
    return [dict(zip(names, row)) for row in done.fetchall()]


def table(found):
    """Rows as text in columns; numbers with five digits, an empty cell where there is no value."""
    def cell(value):
        return '' if value is None else f'{value:.5g}' if isinstance(value, float) else str(value)
    lines = [list(found[0])] + [[cell(value) for value in row.values()] for row in found] if found else [['none']]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return '\n'.join('  '.join(map(str.ljust, line, widths)).rstrip() for line in lines)


def write(file, found):
    """Writes rows as a CSV file."""
    if not found:
        raise Refused(f'{file}: not written, as the query has no rows; give campaigns with such cases')
    with open(file, 'w', encoding='utf-8', newline='') as out:
        writer = csv.DictWriter(out, list(found[0]), lineterminator='\n')
        writer.writeheader()
        writer.writerows(found)


def main():
    parser = argparse.ArgumentParser(prog='tools/campaign-queries/run', description=__doc__.splitlines()[0])
    parser.add_argument('campaign', nargs='+', help='campaign.csv, or a folder that has one; several, of different seeds, are taken together')
    parser.add_argument('--parquet', metavar='FILE', default='campaign.parquet', help='file for the rows [default: campaign.parquet]')
    parser.add_argument('--query', metavar='NAME', help='answer one query only, for example 1-latency')
    parser.add_argument('--csv', metavar='FILE', help='write the rows of --query to a CSV file, and print nothing')
    arguments = parser.parse_args()
    if arguments.csv and not arguments.query:
        parser.error('--csv needs --query: a file has the rows of one query')
    chosen = [query for query in queries() if arguments.query in (None, query.stem)]
    try:
        if not chosen:
            raise Refused(f'--query: there is no {arguments.query}; give one of {", ".join(query.stem for query in queries())}')
        connection = connect(arguments.campaign, arguments.parquet)
    except (Refused, OSError, duckdb.IOException) as error:
        print(f'campaign-queries: {error}', file=sys.stderr)
        return 2
    for query in chosen:
        found = rows(connection, query)
        if not arguments.csv:
            print(f'\n{query.stem}\n{table(found)}')
            continue
        try:
            write(arguments.csv, found)
        except (Refused, OSError) as error:
            print(f'campaign-queries: {error}', file=sys.stderr)
            return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
