"""Folders of a crate, and what each imports: from `use` lines, from paths in code, and by `impl` blocks.

A *folder* is a module directly below the root of a crate, with all that is in it, even if it is a single file. The root itself is no folder:
it may use and re-export all of them. What a folder names by way of the root (`crate::Name`) belongs to the folder that has it.
"""
from collections import Counter
from typing import NamedTuple

from source import Reader

ROOT = 'the root'


class Place(NamedTuple):
    """A place in the code, and how it imports."""

    file: object
    line: int
    how: str


class Folders:
    """Imports between the folders of a crate: `imports[a][b]` are the places where `a` imports `b`."""

    def __init__(self, root_file, is_test=False):
        reader = Reader(root_file, is_test)
        self.root, self.macros, self.files, self.missing = reader.root, reader.macros, reader.files, reader.missing
        self.names = sorted(name for name in self.root.children)
        self.imports = {}
        self.modules = list(below(self.root))
        for module in self.modules:
            self.read_paths(module)
            self.read_impls(module)
        self.read_calls()

    def add(self, module, folder, line, how):
        own = module.folder or ROOT
        if folder and folder != own:
            self.imports.setdefault(own, {}).setdefault(folder, []).append(Place(module.file, line, how))

    def read_paths(self, module):
        for path, line, is_public, is_glob in module.uses:
            if module is self.root and is_public:
                continue  # a re-export: who uses it, is counted there
            how = '::'.join(path) + ('::*' if is_glob else '')
            found = self.module_of(module, path) if is_glob else None
            if found is self.root and module is not self.root:
                self.read_names(module, how)
            else:
                self.add(module, self.target(module, path), line, f'use {how}')
        for path, line in module.paths:
            self.add(module, self.target(module, path), line, '::'.join(path))

    def read_names(self, module, how):
        """Names that a module has by importing all of the root."""
        for name, line in module.names.items():
            known = name in self.root.children or name in self.root.imports or name in self.root.items
            if known and name not in module.imports and name not in module.items and name not in module.children:
                self.add(module, self.target(self.root, (name,)), line, f'{name}, by use {how}')

    def read_impls(self, module):
        for block in module.impls:
            found = self.defined(module, block.target)
            if found:
                self.add(module, found.folder or ROOT, block.line, f'impl for {block.target[-1]}')

    def read_calls(self):
        """Calls of methods that one folder adds to the type of another. Such a call has no `use`, but is an import all the same.

        Only a name that one function of the crate has is recognised.
        """
        count = Counter(name for module in self.modules for name in module.functions)
        added = {}
        for module in self.modules:
            for block in module.impls:
                found = None if block.of_trait else self.defined(module, block.target)
                if found and found.folder != module.folder:
                    for name in block.functions:
                        if count[name] == 1:
                            added[name] = (module, block.target[-1])
        for module in self.modules:
            calls = module.calls + [(path[-1], line) for path, line in module.paths if len(path) > 1]
            for name, line in calls:
                if name in added:
                    where, owner = added[name]
                    self.add(module, where.folder or ROOT, line, f'{owner}::{name}, a method from there')

    def start(self, module, path):
        """Module at which a path starts, and the rest of the path; `None` outside this crate."""
        first, rest = path[0], path[1:]
        if first == 'crate':
            return self.root, rest
        if first == 'self':
            return module, rest
        if first == 'super':
            above = module.parent
            while above and rest[:1] == ('super',):
                above, rest = above.parent, rest[1:]
            return above and (above, rest)
        if first in module.children or first in module.imports:
            return module, path
        return None

    def target(self, module, path):
        """Folder that a path names first, `ROOT` for an item of the root, `None` for what is outside this crate or of no folder."""
        visited = set()
        while True:
            begun = self.start(module, path)
            if begun is None or (begun[0].path, begun[1]) in visited:
                return None
            module, path = begun
            visited.add((module.path, path))
            if module is not self.root:
                return module.folder
            if not path:
                return None
            name = path[0]
            if name in module.children:
                return name
            if name in module.imports:
                path = (*module.imports[name], *path[1:])
                if path[0] == name:  # `use name;` of another crate
                    return None
                continue
            if name in module.items:
                return ROOT
            if name in self.macros:
                return self.macros[name].folder or ROOT
            for one in module.globs:
                there = self.module_of(module, one)
                if there and there is not module and self.has(there, name):
                    return there.folder
            return None

    def module_of(self, module, path):
        """Module that a path names, or `None`."""
        found = self.walk(module, path, set())
        return found[0] if found and found[1] is None else None

    def has(self, module, name):
        return name in module.items or name in module.children or name in module.imports

    def defined(self, module, path):
        """Module in which the type of a path is defined, or `None` outside this crate."""
        if len(path) == 1 and path[0] in module.items:
            return module
        found = self.walk(module, path, set())
        if found is None and len(path) == 1:
            for one in module.globs:
                there = self.module_of(module, one)
                if there:
                    found = found or self.item_in(there, path[0], {(module.path, path)})
        return found[0] if found else None

    def walk(self, module, path, visited):
        """Module of a path and the name of its item, through all re-exports; the name is `None` if the path is a module."""
        begun = self.start(module, path)
        if begun is None or (begun[0].path, begun[1]) in visited:
            return None
        visited.add((begun[0].path, begun[1]))
        module, path = begun
        for i, name in enumerate(path):
            if name in module.children:
                module = module.children[name]
            else:
                return self.item_in(module, name, visited, path[i + 1 :]) or (module, name)
        return module, None

    def item_in(self, module, name, visited, rest=()):
        """Place of an item that a module defines or re-exports, or `None`."""
        if (module.path, name) in visited:
            return None
        visited.add((module.path, name))
        if name in module.items:
            return module, name
        if name in module.imports:
            return self.walk(module, (*module.imports[name], *rest), visited)
        for one in module.globs:
            there = self.module_of(module, one)
            found = there and self.item_in(there, name, visited, rest)
            if found:
                return found
        return None

    def circles(self):
        """Groups of folders each of which imports all others of its group, directly or through others."""
        reach = {}
        for name in self.imports:
            found, left = set(), [name]
            while left:
                new = set(self.imports.get(left.pop(), ())) - found
                found |= new
                left += new
            reach[name] = found
        circles = {frozenset(other for other in reach[name] if name in reach.get(other, ())) for name in reach if name in reach[name]}
        return sorted(sorted(circle) for circle in circles)


def below(module):
    yield module
    for child in module.children.values():
        yield from below(child)
