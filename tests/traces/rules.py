"""rules.toml: how scenes are recorded, how names changed, and which differences are intended."""

import fnmatch
import pathlib
import re
import tomllib

PATH = pathlib.Path(__file__).with_name("rules.toml")
EXCEPTION = {"scene": str, "column": str, "at_most": (int, float), "reason": str}


class Rules:
    """The file's content, with checks of what is written by hand."""

    def __init__(self, content):
        self.options = content.get("options", {})
        self.flags = self.options.get("flags", [])
        self.appended = content.get("append", {})
        self.replaced = content.get("replace", {})
        self.renamed = {new: old for old, new in content.get("columns", {}).items()}
        self.states = {new: old for old, new in content.get("states", {}).items()}
        self.new = content.get("new", {}).get("columns", [])
        self.exceptions = content.get("exception", [])
        for exception in self.exceptions:
            for key, kind in EXCEPTION.items():
                if not isinstance(exception.get(key), kind) or exception[key] == "":
                    raise ValueError(f"{PATH.name}: an exception has no `{key}`: {exception}")

    @classmethod
    def load(cls):
        return cls(tomllib.loads(PATH.read_text(encoding="utf-8")))

    def options_of(self, scene):
        """Options of `cophase run` for a scene. clap refuses an option given twice: the scene's own replaces the common one."""
        chosen = {}
        for options in (self.options.get("all", []), self.options.get(scene, [])):
            chosen.update(zip(options[::2], options[1::2]))
        return [word for option in chosen.items() for word in option]

    def old_name(self, name):
        """The name that a present series had, or None if it is a new one."""
        if any(matches(pattern, name) is not None for pattern in self.new):
            return None
        for new, old in self.renamed.items():
            axis = matches(new, name)
            if axis is not None:
                return old.replace("{i}", axis)
        return name

    def as_of_old(self, series):
        """Series of a present run under old names, states by their old texts: (old name -> series, old name -> new name)."""
        old, names = {}, {}
        for name, one in series.items():
            old_name = self.old_name(name)
            if old_name is None:
                continue
            if old_name in old:
                raise ValueError(f"{PATH.name}: {names[old_name]} and {name} were both {old_name}")
            if name == "state":
                one = [self.states.get(text, text) for text in one]
            old[old_name], names[old_name] = one, name
        return old, names

    def exception(self, scene, name):
        """The first exception for a series of a scene, or None."""
        for exception in self.exceptions:
            column = exception["column"]
            if exception["scene"] == scene and fnmatch.fnmatchcase(name.removeprefix("wire "), column):
                return exception
        return None


def matches(pattern, name):
    """The axis number if a name fits a pattern with `{i}`; "" if it fits one without; else None."""
    expression = re.escape(pattern).replace(re.escape("{i}"), r"(\d+)", 1)
    found = re.fullmatch(expression, name)
    return found and (found.groups() or ("",))[0]
