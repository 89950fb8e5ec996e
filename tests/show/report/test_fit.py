"""The summary of a comparison: order of the models, values with errors, and limits."""

import numpy as np

from erlif.prediction import Candidate, Comparison, Estimate, MotionFit
from erlif.prediction.least_squares import Minimum
from erlif.show.report.fit import summarise_comparison


def comparison(viscosity, inflation=1.0):
    none = np.zeros(0)
    minimum = Minimum(*[none] * 6, inflation, log_likelihood=0.0)
    estimates = {
        "viscosity": viscosity,
        "start_film": Estimate(6.268e-6, 14e-9, 6.24e-6, 6.30e-6, "m"),
    }
    fit = MotionFit("free", estimates, (), minimum, none, none)
    candidates = (
        Candidate("a pin that is free sideways", 0.0, 4, 1.0, 37.6e-9),
        Candidate("a guided pin", 1020.7, 4, 300.0, 9.67e-6),
    )
    return Comparison(candidates, "Squeeze carries the film.", fit, 1.0)


def test_the_verdict_stands_first_then_models_then_values_with_their_errors():
    """A limit of the data is given as one; about a wrong model, the scatter is no error."""
    for viscosity, inflation, words in (
        ((0.1198, 0.0006, 0.1186, 0.121), 1.0, "viscosity: 0.11980 ± 0.00060 Pa s"),
        ((36.9, 84.8, 7.69, np.inf), 1.0, "viscosity: above 7.69 (95 %) Pa s"),
        ((0.0191, 0.0022, 0.015, 0.024), 151.0, "viscosity: about 0.019 Pa s"),
    ):
        text = summarise_comparison(comparison(Estimate(*viscosity, "Pa s"), inflation))
        lines = text.splitlines()
        assert lines[0] == "Squeeze carries the film."
        assert lines[2].split() == ["a", "pin", "that", "is", "free", "sideways", "0", "37.6"]
        assert lines[3].split() == ["a", "guided", "pin", "1021", "9.67e+03"]
        assert words in text
        assert ("film at the first frame: 6.268 ± 0.014 um" in text) == (inflation == 1.0)
        assert ("±" in text) == (inflation == 1.0)
