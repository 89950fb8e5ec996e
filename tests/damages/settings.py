"""Damaged run.toml and fixture.toml, and settings outside physical sense."""

from damages.bench import TEXTS, Damage


def _edit(folder, command, name, old, new, *words):
    """Text of a settings file replaced."""
    file = f"{folder}/{folder}.toml"
    change = lambda bench: bench.edit(bench.directory / file, (old, new))  # noqa: E731
    return Damage(f"{folder}.toml: {name}", change, command, words)


def _whole(name, content, *words):
    change = lambda bench: bench.write(bench.run / "run.toml", content)  # noqa: E731
    return Damage(f"run.toml: {name}", change, "process run", words)


SETTINGS = [
    *(_edit("run", "process run", name, *row) for name, row in TEXTS["run"].items()),
    *(
        _edit("fixture", "calibrate fixture --overwrite", name, *row)
        for name, row in TEXTS["fixture"].items()
    ),
    *(_whole(name, *row) for name, row in TEXTS["run_whole"].items()),
    _whole("binary", bytes(range(256)), "Expected valid TOML"),
    _whole("UTF-16", "[run]\nname = 'a'\n".encode("utf-16"), "Expected valid TOML"),
    _whole("nested without end", "a = " + "[" * 100_000, "Expected valid TOML"),
    _whole("2 MB", "# " + "a" * 2**21, "at most 1 MB are read"),
]
