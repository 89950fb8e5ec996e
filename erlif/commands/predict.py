"""``erlif predict``: maps of the film that theory predicts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.lines import wrap
from erlif.commands.options import ALLOW_OUTSIDE, OVERWRITE, PATH, expect_suffix, output_option
from erlif.commands.progress import working
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("source", metavar="RUN_DIR|FILM", type=PATH)
@output_option("File", "prediction.nc in RUN_DIR or beside FILM")
@click.option("--fit", "fitted", is_flag=True, help="Find which physics carries the film; minutes.")
@ALLOW_OUTSIDE
@OVERWRITE
def predict(source: Path, output: Path | None, fitted: bool, **options: Any) -> None:
    """Predict the film of an oscillating joint at every trigger.

    The transient Reynolds equation is solved over the motion of the frames, for the film in view of
    the camera. A run directory is predicted with its present settings, a film with those that it
    holds.

    --fit prints which physics carries the measured film: steady formulas, squeeze, and the
    transient film of a free and of a guided pin are fitted to the positions of the pin and compared
    by their likelihood, with the viscosity of the best. It needs FILM, or film.nc in RUN_DIR, and
    writes a file only with -o.

    \b
    Example:
      erlif predict data_samples/straight_bushing
      erlif predict data_samples/straight_bushing/film.nc -o guess.nc
    """
    with large_imports():
        from erlif.pipeline.physics.predict import is_film
        from erlif.pipeline.physics.predict import predict as predict_maps
        from erlif.show.report import summarise_prediction

    if output is None and not fitted:
        output = (source.parent if is_film(source) else source) / "prediction.nc"
    if output is not None:
        expect_suffix(output, ".nc")
        with working() as progress:
            prediction = predict_maps(source, output=output, progress=progress, **options)
        with prediction:
            click.echo(wrap(summarise_prediction(prediction)))
        click.echo(f"written: {output}")
    # the fit takes minutes and is asked for
    if fitted:
        from erlif.pipeline.physics.fit import fit_film
        from erlif.show.report.prediction import summarise_comparison

        with working() as progress:
            compared = fit_film(source, progress=progress)
        click.echo(wrap(summarise_comparison(compared)))
