"""Who hears how far long work is."""

import inspect

import pytest

import erlif
from erlif.core.errors import ErlifError
from erlif.core.progress import choose_progress
from erlif.pipeline.physics.fit import fit_film
from erlif.review.check import examine


@pytest.mark.parametrize("asked", ["bar", True])
def test_a_bar_for_each_step(asked, capsys):
    progress = choose_progress(asked)
    for done in (1, 2, 3):
        progress("registration", done, 3)
    progress("film", 1, 4)
    progress("writing", 2, 2)
    shown = capsys.readouterr().err
    for text in ("registration", "3/3", "film", "1/4", "writing", "2/2"):
        assert text in shown


LONG = [
    erlif.batch,
    erlif.budget,
    erlif.calibrate,
    erlif.check,
    erlif.predict,
    erlif.pressure_from_film,
    erlif.process,
    erlif.simulate,
    examine,
    fit_film,
    erlif.report.write_report,
]


@pytest.mark.parametrize("function", LONG, ids=lambda one: one.__name__)
def test_every_long_function_takes_a_bar(function):
    """A wrong value is refused before anything is read."""
    options = inspect.signature(function).parameters
    assert options["progress"].default is None
    needed = ["nowhere"] * sum(
        one.default is one.empty and one.kind is one.POSITIONAL_OR_KEYWORD
        for one in options.values()
    )
    with pytest.raises(ErlifError, match='progress="bar"'):
        function(*needed, progress="dots")
