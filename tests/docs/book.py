#!/usr/bin/env python3
"""Preprocessor of mdBook: links that leave the folder of the book, and those to a folder's README.md.

The book has the pages of docs/ only. A link to a file elsewhere in the repository would lead nowhere, so its path is written beside
its text. `contributing.md` gets the text of CONTRIBUTING.md, which has to lie in the top folder.
"""
import json
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r'(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^()\s]+)\)')


def outward(text, page):
    def change(found):
        mark, words, target = found.groups()
        file = target.partition('#')[0]
        if not file or re.match(r'[a-z][a-z0-9+.-]*:', file):
            return found[0]
        name = os.path.normpath(os.path.join('docs', os.path.dirname(page), file))
        if name.startswith('docs/'):
            return re.sub(r'README\.md(?=[#)])', 'index.md', found[0])  # as mdBook names it
        return words if words.strip('`') == name else f'{words} (`{name}`)'

    return LINK.sub(change, text)


def chapters(items):
    for item in items:
        if isinstance(item, dict) and 'Chapter' in item:
            yield item['Chapter']
            yield from chapters(item['Chapter']['sub_items'])


def main():
    if sys.argv[1:2] == ['supports']:
        return
    _, book = json.load(sys.stdin)
    for chapter in chapters(book['items']):
        page = chapter.get('source_path')
        if page == 'contributing.md':
            text = (ROOT / 'CONTRIBUTING.md').read_text(encoding='utf-8')
            # Links are relative to docs/: files in docs/ are beside the page, and all others are
            # one folder above.
            chapter['content'] = re.sub(r'\]\((?![a-z][a-z0-9+.-]*:|#)(?:docs/)?', lambda m: '](' if 'docs/' in m[0] else '](../', text)
        if page:
            chapter['content'] = outward(chapter['content'], page)
    json.dump(book, sys.stdout)


if __name__ == '__main__':
    main()
