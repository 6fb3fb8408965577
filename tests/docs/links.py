"""Relative links, anchors and pictures of all pages; the table of contents; links of the book that mdBook makes."""
import html.parser
import os
import pathlib
import re
import urllib.parse

from pages import ROOT, Page


def check(pages):
    """Problems, and the links to elsewhere."""
    by_name = {page.name: page for page in pages}
    problems, external = [], {}
    for page in pages:
        for position, target, _ in page.links():
            where = f'{page.name}:{page.line(position)}'
            if re.match(r'[a-z][a-z0-9+.-]*:', target):
                external.setdefault(target, where)
                continue
            file, _, anchor = target.partition('#')
            name = os.path.normpath(os.path.join(os.path.dirname(page.name), urllib.parse.unquote(file))) if file else page.name
            if name.startswith('..') or not (name in by_name or (ROOT / name).exists()):
                problems.append(f'{where}: the link {target} leads to no file; correct its path')
            elif anchor and name.endswith('.md'):
                # A page outside the list comes from a self-test.
                if anchor not in (by_name.get(name) or Page(name)).anchors():
                    problems.append(f'{where}: {name} has no heading for #{anchor}; correct the anchor')
    return problems, external


def check_summary(pages):
    """Each page of the manual is in its table of contents, once."""
    summary = next((page for page in pages if page.name == 'docs/SUMMARY.md'), None)
    if summary is None:
        return []
    listed = [os.path.normpath(f'docs/{target}') for _, target, _ in summary.links()]
    there = [page.name for page in pages if page.name.startswith('docs/') and page is not summary]
    problems = [f'docs/SUMMARY.md: lists {name} more than once' for name in sorted(set(listed)) if listed.count(name) > 1]
    return problems + [f'docs/SUMMARY.md: does not list {name}; add it' for name in there if name not in listed]


class _Html(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.targets, self.ids = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.ids.update(filter(None, (attributes.get('id'), attributes.get('name'))))
        self.targets += filter(None, (attributes.get('href'), attributes.get('src')))


def check_book(folder):
    """Links, anchors and pictures of the pages as mdBook made them."""
    folder = pathlib.Path(folder)
    files = {path: _Html(path.read_text(encoding='utf-8')) for path in sorted(folder.rglob('*.html'))}
    problems = []
    for path, page in files.items():
        if path.name in ('print.html', '404.html', 'toc.html'):  # made from the other pages; anchors there are joined
            continue
        for target in page.targets:
            if re.match(r'[a-z][a-z0-9+.-]*:', target):
                continue
            file, _, anchor = target.partition('#')
            other = (path.parent / urllib.parse.unquote(file)).resolve() if file else path.resolve()
            inside = other.is_relative_to(folder.resolve())
            found = next((files[p] for p in files if p.resolve() == other), None)
            if not inside or not other.exists():
                problems.append(f'{path}: the link {target} leads to no file of the book')
            elif anchor and found and urllib.parse.unquote(anchor) not in found.ids:
                problems.append(f'{path}: the link {target} has no anchor there')
    return problems
