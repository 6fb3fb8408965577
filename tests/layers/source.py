"""Modules of a Rust crate: what each declares, imports and names. Reads text only, without a compiler.

Code of tests (`#[cfg(test)]`, `#[test]`) is left out: a test may use what lies above.
"""
import re

TOKEN = re.compile(
    r'''(?P<space>\s+|//[^\n]*)
    |(?P<comment>/\*)
    |(?P<raw>[bc]?r(?P<hashes>\#*)"(?:.*?)"(?P=hashes))
    |(?P<string>[bc]?"(?:\\.|[^"\\])*")
    |(?P<character>b?'(?:\\(?:u\{[^}]*\}|x..|.)|[^\\'\n])')
    |(?P<lifetime>'\w+)
    |(?P<name>(?:r\#)?[^\W\d]\w*)
    |(?P<number>\d(?:\w|\.(?=\d))*)
    |(?P<sign>::|->|=>|.)''',
    re.X | re.S,
)
CLOSING = {'(': ')', '[': ']', '{': '}'}
# Words that may precede a type in the header of an `impl`, and those that begin an item.
BEFORE_TYPE = {'&', 'mut', 'dyn', '(', '!'}
DECLARES = {'struct', 'enum', 'union', 'trait', 'type', 'fn', 'const', 'static'}
ITEM = DECLARES | {'pub', 'mod', 'use', 'impl', 'unsafe', 'async', 'extern', 'macro_rules', 'let'}


class Token:
    __slots__ = ('text', 'kind', 'line')

    def __init__(self, text, kind, line):
        self.text, self.kind, self.line = text, kind, line


def tokens(text):
    """Tokens of a file without spaces and comments."""
    found, at, line = [], 0, 1
    while at < len(text):
        match = TOKEN.match(text, at)
        kind, piece = match.lastgroup, match[0]
        if kind == 'comment':
            piece = text[at:end_of_comment(text, at)]
        elif kind != 'space':
            found.append(Token(piece.removeprefix('r#') if kind == 'name' else piece, kind, line))
        line += piece.count('\n')
        at += len(piece)
    return found


def end_of_comment(text, at):
    depth = 0
    for mark in re.compile(r'/\*|\*/').finditer(text, at):
        depth += 1 if mark[0] == '/*' else -1
        if depth == 0:
            return mark.end()
    return len(text)


class Module:
    """A module, inline or in a file of its own. `folder` is its first name below the crate's root, '' for the root."""

    def __init__(self, path, file, parent=None):
        self.path, self.file, self.parent = path, file, parent
        self.folder = path[0] if path else ''
        self.children, self.items = {}, set()
        self.imports, self.globs = {}, []  # name -> path as written; paths of `use x::*`
        self.uses, self.paths = [], []     # (path as written, line, whether public), (path as written, line)
        self.impls = []                    # Impl
        self.functions = []                # names of all functions
        self.calls = []                    # (method, line), on any value
        self.names = {}                    # name -> line of its first occurrence

    @property
    def root(self):
        return self.parent.root if self.parent else self


class Impl:
    """A block `impl T` (`of_trait` is false) or `impl Trait for T`, with its functions."""

    def __init__(self, target, of_trait, line):
        self.target, self.of_trait, self.line = target, of_trait, line
        self.functions = []


class Reader:
    """Reads a crate from the file of its root. `is_test`: the crate is a test itself, so that all of it is read."""

    def __init__(self, root_file, is_test):
        self.is_test = is_test
        self.macros = {}  # exported macro -> folder
        self.files = 0
        self.missing = []  # (file, module) of `mod` lines without a file
        self.root = Module((), root_file)
        self.read(self.root, root_file.parent)

    def read(self, module, folder):
        self.files += 1
        self.scan(module, tokens(module.file.read_text()), folder)

    def child(self, module, name, folder, path):
        """Reads the file of `mod name;`."""
        if path:
            candidates = [(folder if path[0] == 'inline' else module.file.parent) / path[1]]
            places = [candidates[0].parent]
        else:
            candidates = [folder / f'{name}.rs', folder / name / 'mod.rs']
            places = [folder / name] * 2
        for file, place in zip(candidates, places):
            if file.is_file():
                module.children[name] = Module((*module.path, name), file.resolve(), module)
                self.read(module.children[name], place)
                return
        self.missing.append((module.file, name))

    def scan(self, module, all_tokens, folder, is_inline=False):
        """Reads the tokens of a module. `folder` has the files of its children."""
        Scan(self, module, all_tokens, folder, is_inline).run()


class Scan:
    def __init__(self, reader, module, all_tokens, folder, is_inline):
        self.reader, self.module, self.tokens = reader, module, all_tokens
        self.folder, self.is_inline = folder, is_inline
        self.at, self.depth = 0, 0
        self.open_impls = []  # (depth of its block, Impl)
        self.is_test, self.path, self.is_exported = False, None, False

    def text(self, ahead=0):
        at = self.at + ahead
        return self.tokens[at].text if 0 <= at < len(self.tokens) else ''

    def kind(self, ahead=0):
        at = self.at + ahead
        return self.tokens[at].kind if 0 <= at < len(self.tokens) else ''

    def line(self):
        return self.tokens[self.at].line

    def run(self):
        while self.at < len(self.tokens):
            text, kind = self.text(), self.kind()
            if text == '#' and self.text(1) in ('[', '!'):
                if not self.attribute():
                    return
                continue
            if self.is_test:
                self.skip_item()
                self.is_test = False
            elif kind == 'name':
                self.name(text)
            else:
                if text == '{':
                    self.depth += 1
                elif text == '}':
                    self.depth -= 1
                    if self.open_impls and self.open_impls[-1][0] == self.depth:
                        self.open_impls.pop()
                self.at += 1
            if text in ('mod', 'macro_rules'):
                self.path, self.is_exported = None, False

    def attribute(self):
        """Reads an attribute. Returns false if it excludes the whole module."""
        is_inner = self.text(1) == '!'
        self.at += 2 if is_inner else 1
        if self.text() != '[':
            return True
        end = self.closing(self.at)
        inside = self.tokens[self.at + 1 : end]
        words = ''.join(token.text for token in inside)
        self.at = end + 1
        is_test = words == 'test' or words.startswith('cfg(') and requires_test(words[4:-1])
        is_test &= not self.reader.is_test
        if is_inner:
            return not is_test
        self.is_test |= is_test
        if len(inside) == 3 and inside[0].text == 'path':
            self.path = inside[2].text[1:-1]
        self.is_exported |= words == 'macro_export'
        return True

    def closing(self, at):
        """Index of the bracket that closes the one at `at`."""
        opening = self.tokens[at].text
        depth = 0
        for i in range(at, len(self.tokens)):
            if self.tokens[i].text == opening:
                depth += 1
            elif self.tokens[i].text == CLOSING[opening]:
                depth -= 1
                if depth == 0:
                    return i
        return len(self.tokens)

    def skip_item(self):
        """Skips an item, or a field or an arm, that exists in tests only."""
        is_item = self.text() in ITEM
        ends_at_brace = is_item and self.text() not in ('use', 'let', 'const', 'static')
        while self.at < len(self.tokens):
            text = self.text()
            if text == ';' or text == ',' and not is_item:
                self.at += 1
                return
            if text in (')', ']', '}'):
                return
            if text in CLOSING:
                self.at = self.closing(self.at) + 1
                if text == '{' and (ends_at_brace or not is_item):
                    return
            else:
                self.at += 1

    def name(self, text):
        before = self.text(-1)
        module = self.module
        module.names.setdefault(text, self.line())
        if text == 'use':
            self.use()
        elif text == 'mod' and self.kind(1) == 'name' and self.text(2) in (';', '{'):
            self.mod()
        elif text == 'impl' and before in ('', ';', '}', '{', ']', 'unsafe', 'default'):
            self.impl()
        elif text == 'macro_rules' and self.text(1) == '!':
            name = self.text(2)
            module.items.add(name)
            if self.is_exported:
                self.reader.macros[name] = module
            self.at += 3
        elif text in DECLARES and self.kind(1) == 'name' and self.text(1) not in ('fn', 'unsafe', 'async', 'mut', 'extern'):
            self.declaration(text)
        elif before == '.' and self.text(1) in ('(', '::'):
            module.calls.append((text, self.line()))
            self.at += 1
        elif self.text(1) == '::' and before not in ('::', '.'):
            self.path_in_code()
        else:
            self.at += 1

    def declaration(self, kind):
        name = self.text(1)
        if self.depth == 0:
            self.module.items.add(name)
        if kind == 'fn':
            self.module.functions.append(name)
            if self.open_impls and self.open_impls[-1][0] + 1 == self.depth:
                self.open_impls[-1][1].functions.append(name)
        self.at += 2

    def path_in_code(self):
        line, segments = self.line(), [self.text()]
        if self.text(-1) == '$' and segments[0] != 'crate':
            self.at += 1
            return
        while self.text(1) == '::' and self.kind(2) == 'name':
            self.at += 2
            segments.append(self.text())
        self.at += 1
        if len(segments) > 1:
            self.module.paths.append((tuple(segments), line))

    def use(self):
        line = self.line()
        is_public = self.text(-1) == 'pub' or self.text(-1) == ')' and self.text(-4) == 'pub'  # `pub(crate)`
        self.at += 1
        if self.text() == '::':
            self.at += 1
        for path, name in self.tree(()):
            if not path or '$' in path and path[:2] != ('$', 'crate'):
                continue
            path = path[1:] if path[0] == '$' else path
            if name == '*':
                self.module.globs.append(path)
            elif name != '_':
                self.module.imports[name] = path
            self.module.uses.append((path, line, is_public, name == '*'))

    def tree(self, prefix):
        """Paths of a `use` tree, each with the name that it gets here."""
        path = list(prefix)
        while self.at < len(self.tokens):
            text = self.text()
            self.at += 1
            if text == '{':
                while self.text() not in ('}', ''):
                    yield from self.tree(tuple(path))
                    if self.text() == ',':
                        self.at += 1
                self.at += 1
                return
            if text == '*':
                yield tuple(path), '*'
                return
            if text == '::':
                continue
            if text == ';':
                self.at -= 1
                return
            path.append(text)
            if self.text() == '::' or text == '$':
                continue
            if path[-1] == 'self' and len(path) > 1:
                path.pop()
            name = path[-1]
            if self.text() == 'as':
                name = self.text(1)
                self.at += 2
            yield tuple(path), name
            return

    def mod(self):
        name, is_inline = self.text(1), self.text(2) == '{'
        self.at += 2
        if not is_inline:
            path = self.path and ('inline' if self.is_inline else 'file', self.path)
            self.reader.child(self.module, name, self.folder, path)
            self.at += 1
            return
        end = self.closing(self.at)
        child = Module((*self.module.path, name), self.module.file, self.module)
        self.module.children[name] = child
        self.reader.scan(child, self.tokens[self.at + 1 : end], self.folder / name, True)
        self.at = end + 1

    def impl(self):
        line = self.line()
        self.at += 1
        start, target, angle = self.at, self.at, 0
        of_trait = False
        while self.at < len(self.tokens):
            text = self.text()
            if text == '<':
                angle += 1
            elif text == '>':
                angle -= 1
                if angle == 0 and self.at > start and target == start and self.tokens[start].text == '<':
                    target = self.at + 1
            elif text in ('(', '['):
                self.at = self.closing(self.at)
            elif angle == 0 and text == 'for' and self.text(1) != '<':
                of_trait, target = True, self.at + 1
            elif angle == 0 and text in ('{', 'where', ';'):
                break
            self.at += 1
        block = Impl(self.type_at(target), of_trait, line)
        self.at = start  # the header names paths, too
        if block.target:
            self.module.impls.append(block)
        self.open_impls.append((self.depth, block))

    def type_at(self, at):
        """Path of the type that begins at a token; empty if it is none."""
        while at < len(self.tokens) and (self.tokens[at].text in BEFORE_TYPE or self.tokens[at].kind == 'lifetime'):
            at += 1
        path = []
        while at < len(self.tokens) and self.tokens[at].kind == 'name':
            path.append(self.tokens[at].text)
            if at + 1 < len(self.tokens) and self.tokens[at + 1].text == '::':
                at += 2
            else:
                break
        return tuple(path)


def requires_test(condition):
    """True if a condition of `cfg` holds in tests only."""
    if condition == 'test':
        return True
    if not condition.startswith('all('):
        return False
    parts, depth, start = [], 0, 4
    for i, character in enumerate(condition[4:-1] + ',', 4):
        depth += (character == '(') - (character == ')')
        if character == ',' and depth == 0:
            parts.append(condition[start:i])
            start = i + 1
    return any(requires_test(part) for part in parts)
