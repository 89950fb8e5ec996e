"""``erlif sources``: published numbers beside what the models give."""

from __future__ import annotations

import click

from erlif.core.speed.imports import large_imports


@click.command()
def sources() -> None:
    """Print the published numbers of the sources beside the numbers of the models.

    \b
    Example:
      erlif sources > docs/sources.md
    """
    with large_imports():
        from erlif.models.sources import render_sources

    click.echo(render_sources(), nl=False)
