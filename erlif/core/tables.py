"""Tables and templates of texts that stand in files beside the modules that read them."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment


@cache
def read_table(package: str, name: str) -> dict[str, Any]:
    """Read a table of the package.

    Parameters
    ----------
    package : str
        Package in whose folder the file lies.
    name : str
        Name of the file.

    Returns
    -------
    dict
        The same one for every caller; not to be changed.

    Examples
    --------
    >>> read_table("erlif.core", "variables.toml")["film"]["frames_used"]["dtype"]
    'int64'
    """
    return tomllib.loads(resources.files(package).joinpath(name).read_text(encoding="utf-8"))


def fill_template(package: str, name: str, /, **values: Any) -> str:
    """Fill a template of plain text.

    Parameters
    ----------
    package : str
        Package in whose folder ``templates`` the file lies.
    name : str
        Name of the file.
    **values
        What it names; a name that is not given is refused.

    Returns
    -------
    str

    Examples
    --------
    >>> from erlif.rig import RigSettings
    >>> text = fill_template(
    ...     "erlif.rig", "fixture.toml", rig=RigSettings(), bands=(580.0, 610.0), background=False
    ... )
    >>> text.splitlines()[0]
    '[fixture]'
    """
    return text_templates(package).get_template(name).render(**values)


@cache
def text_templates(package: str) -> Environment:
    """The templates of plain text in the folder ``templates`` of a package."""
    from jinja2 import Environment, PackageLoader, StrictUndefined  # few commands need it

    return Environment(
        loader=PackageLoader(package),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
