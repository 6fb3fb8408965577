"""Crates of a workspace, and their folders against the rows of layers.toml."""
import tomllib

from folders import ROOT, Folders

EXAMPLES = 3  # places that are shown for each import in a circle


def packages(workspace):
    """Name and folder of each member of a workspace."""
    members = tomllib.loads((workspace / 'Cargo.toml').read_text())['workspace']['members']
    for pattern in members:
        for folder in sorted(workspace.glob(pattern)):
            manifest = tomllib.loads((folder / 'Cargo.toml').read_text())
            yield manifest['package']['name'], folder, manifest


def roots(folder, manifest):
    """Root files of a package, each with true if it is a test: its library or program first, then tests, benchmarks and examples."""
    package = manifest['package']
    files = [(folder / manifest.get('lib', {}).get('path', 'src/lib.rs'), False), (folder / 'src/main.rs', False)]
    for kind, place in (('bin', 'src/bin'), ('test', 'tests'), ('bench', 'benches'), ('example', 'examples')):
        found = [folder / target['path'] for target in manifest.get(kind, []) if 'path' in target]
        if package.get('autobins' if kind == 'bin' else f'auto{place}', True):
            found += sorted(folder.glob(f'{place}/*.rs')) + sorted(folder.glob(f'{place}/*/main.rs'))
        files += [(file, kind == 'test') for file in found]
    return list(dict.fromkeys((file.resolve(), is_test) for file, is_test in files if file.is_file()))


class Layers:
    """The contents of layers.toml."""

    def __init__(self, path):
        table = tomllib.loads(path.read_text())
        self.path = path
        self.rows = {name: crate['rows'] for name, crate in table.items()}


def shown(place, workspace):
    file = place.file
    return f'{file.relative_to(workspace) if file.is_relative_to(workspace) else file}:{place.line}: {place.how}'


def circle_problems(folders, label, workspace):
    for circle in folders.circles():
        lines = [f'{label}: a circle of {len(circle)} folders: {", ".join(circle)}']
        for importer in circle:
            for imported, places in sorted(folders.imports[importer].items()):
                if imported in circle:
                    lines.append(f'    {importer} imports {imported}, {len(places)} times:')
                    lines += [f'        {shown(place, workspace)}' for place in places[:EXAMPLES]]
        yield '\n'.join(lines)


def layer_problems(folders, name, rows, workspace):
    row_of = {}
    for number, row in enumerate(rows):
        for folder in row:
            if folder in row_of:
                yield f'layers.toml: {name} has {folder} twice'
            row_of[folder] = number
    for folder in folders.names:
        if folder not in row_of:
            yield f'layers.toml: {name} has no row for its folder {folder}; list it'
    for folder in row_of:
        if folder not in folders.names:
            yield f'layers.toml: {name} has no folder {folder}; remove it'
    for importer, all_imported in sorted(folders.imports.items()):
        if importer == ROOT:
            continue
        for imported, places in sorted(all_imported.items()):
            if importer in row_of and imported in row_of and row_of[imported] > row_of[importer]:
                for place in places:
                    yield f'{shown(place, workspace)}: {imported} is above {importer}'


def check(workspace, path=None):
    """Problems in all crates of a workspace, and what has been read."""
    workspace = workspace.resolve()
    layers = Layers(path or workspace / 'tests/layers/layers.toml')
    problems, files, crates = [], 0, 0
    known = set()
    for name, folder, manifest in packages(workspace):
        known.add(name)
        for number, (root_file, is_test) in enumerate(roots(folder, manifest)):
            folders = Folders(root_file, is_test)
            files += folders.files
            crates += 1
            for file, module in folders.missing:
                problems.append(f'{file.relative_to(workspace)}: mod {module} has no file that is found here')
            problems += circle_problems(folders, root_file.relative_to(workspace), workspace)
            if number == 0 and name in layers.rows:
                problems += layer_problems(folders, name, layers.rows[name], workspace)
    for name in layers.rows:
        if name not in known:
            problems.append(f'layers.toml: there is no crate {name}; remove it')
    return problems, f'{files} files of {crates} crates; {len(layers.rows)} have layers'


def imports(workspace, name):
    """Prints what each folder of a crate imports."""
    for package, folder, manifest in packages(workspace):
        if package == name:
            folders = Folders(*roots(folder, manifest)[0])
            for importer, all_imported in sorted(folders.imports.items()):
                for imported, places in sorted(all_imported.items()):
                    print(f'{importer} imports {imported}, {len(places)} times: {shown(places[0], workspace)}')
            return 0
    print(f'there is no crate {name}')
    return 2
