"""A calibration in a few lines for the terminal."""

from __future__ import annotations

import numpy as np

from erlif.calibration import Calibration
from erlif.core.notes import Level, rank_notes
from erlif.core.units import count_of
from erlif.show.report.layout import TABLES, print_rows

_TITLE = 34  # columns of the titles
_AT = (0.1, 0.5)  # places in the calibrated range whose uncertainty is printed


def describe_calibration(calibration: Calibration, *, brief: bool = False) -> str:
    """Describe a calibration: parameters with standard deviations, calibrated range and notes.

    Parameters
    ----------
    calibration : Calibration
        From `erlif.calibrate` or `erlif.open_calibration`.
    brief : bool
        Count the notes that are no warnings.

    Returns
    -------
    str
        Fixture and points; parameters, range and errors; the notes, each on its line.

    Examples
    --------
    >>> from erlif.show.plots import example_calibration
    >>> print(*describe_calibration(example_calibration()).splitlines()[:3], sep="\\n")
    example wedge: ratio camera 2 / camera 1 against thickness, 20 points
      K, ratio of a vanishing film      0.66000 ± 0.00100
      p, attenuation camera 1 [1/um]    0.39000 ± 0.00200
    """
    points = calibration.curve.sizes["bin"]
    names = TABLES["summary"]["calibration"]
    stds = calibration.standard_deviations
    rows = {
        name: f"{value:.5f} ± {std:.5f}"
        for name, value, std in zip(names, calibration.parameters, stds, strict=False)
    }

    low, high = calibration.thickness_range
    rows["calibrated range"] = f"{low:.2f} to {high:.2f} um"
    # the calibration shifts all pixels alike, which no average reduces
    places = np.array([low + share * (high - low) for share in _AT])
    errors = calibration.thickness_std(places)
    shares = [f"{100 * e / t:.2f} % at {t:.1f} um" for t, e in zip(places, errors, strict=True)]
    rows["error shared by all pixels"] = ", ".join(shares)
    rows["reduced chi-square"] = f"{calibration.reduced_chi_square:.2f}"

    if calibration.departure is not None:
        film = np.linspace(low, high, 501)
        share = 100 * np.expm1(calibration.departure.predict(film))
        text = f"{share.min():+.2f} to {share.max():+.2f} % of the ratio, followed by a spline"
        rows["departure from the model"] = text
    head = f"{calibration.fixture}: ratio camera 2 / camera 1 against thickness, {points} points"
    ranked = rank_notes(calibration.notes)
    shown = [note for note in ranked if not brief or note.level is not Level.NOTE]
    notes = [f"  {note.level.value}: {note}" for note in shown]
    if left := len(ranked) - len(shown):
        rows["more"] = f"{count_of(left, 'note')}: -v"
    return "\n".join([print_rows(head, rows, width=_TITLE), *notes])
