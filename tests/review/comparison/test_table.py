"""A comparison in words."""

import numpy as np
import pytest

from erlif.review.comparison import compare, describe_comparison


def same(film, other):
    return film


def dark(film, other):
    return other.assign({name: other[name] * np.nan for name in ("film_min", "film_mean")})


def whole(film, other):
    """The region of interest is the whole image."""
    text = other.attrs["settings"]
    start = text.index("[thickness.roi]")
    return other.assign_attrs(settings=text[:start] + text[text.index("\n[", start) :])


@pytest.mark.parametrize(
    ("second", "words"),
    [
        (
            lambda film, other: other,
            (
                "minimum film +0.500 ± ",
                "all runs together: minimum film n = ",
                "conclusion: example (1) and example (2) differ in minimum film and mean film",
            ),
        ),
        (same, ("conclusion: no two runs differ", "no difference found (one of 0.0")),
        (dark, ("conclusion: no runs could be compared",)),
        (whole, ("regions of the film statistics differ",)),
    ],
)
def test_the_conclusion_states_what_differs_or_could_be_found(film, other, second, words):
    text = "\n".join(describe_comparison(compare([film, second(film, other)])))
    assert all(word in text for word in words)
    assert ("regions" in text) == (second is whole)
