"""Documents as the checks see them: code, headings with their anchors, links and pictures, each with its line."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]

FENCE = re.compile(r'^(?P<indent> *)(?P<fence>```+)(?P<language>[^\n`]*)\n(?P<code>.*?)^ *(?P=fence) *$', re.S | re.M)
SPAN = re.compile(r'(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)', re.S)
LINK = re.compile(r'(?P<picture>!?)\[(?:[^\[\]]|\[[^\[\]]*\])*\]\((?P<target>[^()\s]+)(?: "[^"]*")?\)')
HEADING = re.compile(r'^(#{1,6}) +(.+?) *#*$', re.M)


class Page:
    """A Markdown file. `name` is its path from the top folder."""

    def __init__(self, name, text=None):
        self.name = name
        self.path = ROOT / name
        self.text = self.path.read_text(encoding='utf-8') if text is None else text
        self.code = list(self._code())
        blank = bytearray(b'\0' * len(self.text))
        for start, end, *_ in self.code:
            blank[start:end] = b'\1' * (end - start)
        # The same length and lines, without code blocks and comments.
        prose = ''.join(' ' if blank[i] and c != '\n' else c for i, c in enumerate(self.text))
        self.prose = re.sub(r'<!--.*?-->', lambda m: re.sub(r'[^\n]', ' ', m[0]), prose, flags=re.S)

    def line(self, position):
        return self.text.count('\n', 0, position) + 1

    def _code(self):
        """Code blocks as (start, end, language, [(position, line)])."""
        fenced = []
        for found in FENCE.finditer(self.text):
            at, lines = found.start('code'), []
            for line in found['code'].splitlines(keepends=True):
                lines.append((at, line.strip()))
                at += len(line)
            fenced.append((found.start(), found.end(), found['language'].strip(), lines))
        yield from fenced
        # Indented code begins after an empty line. Inside a list it is indented by four more than the item's text.
        at, depth, before, block = 0, 0, '', None
        for line in self.text.splitlines(keepends=True):
            inside = any(start <= at < end for start, end, *_ in fenced)
            item = re.match(r'( *)(?:[-*]|\d+\.) +', line)
            indent = len(line) - len(line.lstrip(' '))
            if block and (inside or line.strip() and indent < block[2]):
                yield block[0], block[1], '', block[3]
                block = None
            if not inside and line.strip():
                if block is None and not before.strip() and indent >= depth + 4:
                    block = [at, at, depth + 4, []]
                if block is None and item:
                    depth = item.end()
                elif block is None and indent < depth and not before.strip():
                    depth = 0
                if block:
                    block[3].append((at + indent, line.strip()))
                    block[1] = at + len(line)
            before, at = line, at + len(line)
        if block:
            yield block[0], block[1], '', block[3]

    def spans(self):
        """Inline code as (position, text)."""
        for found in SPAN.finditer(self.prose):
            yield found.start(2), re.sub(r'\s+', ' ', found[2].strip())

    def without_spans(self):
        return SPAN.sub(lambda m: re.sub(r'[^\n]', ' ', m[0]), self.prose)

    def links(self):
        """Links and pictures as (position, target, is a picture)."""
        # A link's text may have inline code, its target has none.
        for found in LINK.finditer(self.prose):
            yield found.start(), found['target'], bool(found['picture'])

    def anchors(self):
        """Anchors of the headings, as GitHub and mdBook both make them."""
        counts, anchors = {}, set()
        for found in HEADING.finditer(self.prose):
            title = re.sub(r'\]\([^)]*\)', ']', found[2])
            title = re.sub(r'[^\w\s-]', '', title.strip()).lower()
            anchor = re.sub(r'\s', '-', title)
            count = counts.get(anchor, 0)
            counts[anchor] = count + 1
            anchors.add(f'{anchor}-{count}' if count else anchor)
        return anchors


def tracked(*patterns):
    """Files of the repository that git knows or would add, by pattern."""
    command = ['git', 'ls-files', '-z', '--cached', '--others', '--exclude-standard', '--', *patterns]
    names = subprocess.check_output(command, cwd=ROOT, text=True).split('\0')
    return sorted({name for name in names if name and (ROOT / name).is_file()})


def pages():
    return [Page(name) for name in tracked('*.md')]
