"""Tables beside the modules that read them."""

from pathlib import Path

from erlif.core.tables import read_table

PACKAGE = Path(__file__).parents[2] / "erlif"


def test_every_table_is_read_once():
    for path in PACKAGE.rglob("*.toml"):
        package = ".".join(path.parent.relative_to(PACKAGE.parent).parts)
        assert read_table(package, path.name) is read_table(package, path.name)
