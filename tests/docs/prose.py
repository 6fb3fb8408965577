"""Prose of source files and documents: their comments, strings and paragraphs, and the sentences in these."""
import re

# Comments and strings of each language; all else is code.
C_COMMENT = r'(?P<comment>//[^\n]*|/\*.*?\*/)'
C_STRING = r'"(?:\\.|[^"\\])*"'
HASH_COMMENT = r'(?P<comment>\#[^\n]*)'
QUOTED = r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
TRIPLE = r'"""(?:\\.|[^\\])*?"""|\'\'\'(?:\\.|[^\\])*?\'\'\''
REGEX = r'/(?![*/ ])(?:\\.|\[(?:\\.|[^\]\\\n])*\]|[^/\\\[\n])+/'
LEXERS = {
    'rs': rf'{C_COMMENT}|(?P<string>r(?P<hashes>\#*)".*?"(?P=hashes)|{C_STRING})|\'(?:\\.[^\']*|[^\'\\])\'',
    'mjs': rf'{C_COMMENT}|(?P<string>`(?:\\.|[^`\\])*`|{QUOTED}|(?<=[(,=:\[!&|?{{;]){REGEX}|(?<=[(,=:\[!&|?{{;] ){REGEX})',
    'py': rf'{HASH_COMMENT}|(?P<string>{TRIPLE}|{QUOTED})',
    'toml': rf'{HASH_COMMENT}|(?P<string>{TRIPLE}|{QUOTED})',
    'sh': rf'(?<![$\w{{]){HASH_COMMENT}|(?P<string>{QUOTED})',
}
LEXERS = {name: re.compile(pattern, re.S) for name, pattern in LEXERS.items()}


def language(path, text):
    extension = path.rsplit('.', 1)[-1] if '.' in path.rsplit('/', 1)[-1] else ''
    if extension in ('rs', 'mjs', 'py', 'toml', 'md', 'svg'):
        return extension
    return 'sh' if extension == 'sh' or text.startswith('#!') and 'sh' in text.split('\n', 1)[0] else None


def segments(kind, text):
    """Pieces of a file as (is_prose, start, text)."""
    if kind == 'md':
        yield True, 0, re.sub(r'\]\([^)\n]*\)', lambda m: ']' + ' ' * (len(m[0]) - 1), text)
        return
    if kind == 'svg':  # the words of a picture
        for found in re.finditer(r'<(?:text|title|tspan)\b[^>]*>([^<]+)', text):
            yield True, found.start(1), found[1]
        return
    end = 0
    for found in LEXERS[kind].finditer(text):
        if found.start() > end:
            yield False, end, text[end:found.start()]
        if found['comment'] or found['string']:
            yield True, found.start(), found[0]
        end = found.end()
    if end < len(text):
        yield False, end, text[end:]


def blocks(kind, text):
    """Runs of prose as (start of each character, joined text): neighbouring comment lines, strings, paragraphs."""
    run, at, last = [], [], None
    for is_prose, start, piece in segments(kind, text):
        if not is_prose:
            if piece.strip():
                yield run, at
                run, at = [], []
            continue
        opened = bool(re.match(r'//|#', piece))
        if not (opened and run):
            yield run, at
            run, at = [], []
        lead = re.match(r'//[/!]?|#', piece)
        for i, character in enumerate(piece):
            if lead and i < lead.end():
                continue
            run.append(' ' if character == '\n' else character)
            at.append(start + i)
        run.append(' ')
        at.append(start + len(piece))
        if not opened:
            yield run, at
            run, at = [], []
    yield run, at


def read(path):
    try:
        return path.read_text(encoding='utf-8')
    except UnicodeDecodeError:
        return ''


def sentences(path):
    """Sentences of a document, or of a source file's comments, with their lines."""
    text = read(path)
    if path.suffix == '.md':
        text = re.sub(r'^```.*?^```', lambda m: '\n' * m[0].count('\n'), text, flags=re.S | re.M)
        text = re.sub(r'^(\|| {4}|#).*$', '', text, flags=re.M)
        paragraphs, line = [], 1
        for paragraph in re.split(r'(\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) ))', text):
            paragraphs.append((line, re.sub(r'^\s*(?:[-*]|\d+\.) ', '', paragraph)))
            line += paragraph.count('\n')
    else:
        kind = language(str(path), text)
        paragraphs = []
        for run, at in blocks(kind, text) if kind else ():
            if at and re.match(r'//|#', text[max(0, at[0] - 3):at[0]].lstrip() or ' '):
                paragraphs.append((text.count('\n', 0, at[0]) + 1, ''.join(run)))
    for line, paragraph in paragraphs:
        paragraph = re.sub(r'\]\([^)]*\)', ']', paragraph)
        for sentence in re.split(r'(?<=[.!?:])\s+(?=[A-Z`*\[(])|(?<=[.!?])\s+(?=\d)', paragraph):
            count = len(re.findall(r"[\w`][\w`'’.,/·°%-]*", sentence))
            if count:
                yield line, count, ' '.join(sentence.split())
