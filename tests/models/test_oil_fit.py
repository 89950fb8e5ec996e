"""Laws fitted to measured viscosities, and the constants of common oils."""

import numpy as np
import numpy.testing as npt
import pytest

from erlif.models.oil import vogel_viscosity
from erlif.models.oil_fit import fit_viscosity, iso_vg_viscosity, sae_oil

T = np.array([283.15, 298.15, 313.15, 333.15, 353.15, 373.15, 393.15])
LAW = {"a": 6e-5, "b": 950.0, "c": 178.0}


def walther(temperature):
    """ASTM D341 through 140 mm2/s at 40 and 13.5 at 100 degrees: W is linear in log T."""
    ends = np.log10(np.log10([14.2, 140.7]))
    w = ends[1] + np.diff(ends)[0] * np.log(temperature / 313.15) / np.log(313.15 / 373.15)
    return (10**10**w - 0.7) * 1e-6


def law_of(law, temperature=T):
    return vogel_viscosity(temperature, **LAW) if law == "vogel" else walther(temperature)


@pytest.mark.parametrize("law", ["vogel", "walther"])
def test_points_of_a_law_give_it_again(law):
    fit = fit_viscosity(T, viscosities=law_of(law), law=law)
    assert fit.scatter < 1e-9
    npt.assert_allclose(fit.viscosity(T).value, law_of(law), rtol=1e-8)
    if law == "vogel":
        npt.assert_allclose(list(fit.constants.values()), [6e-5, 950.0, 178.0], rtol=1e-5)
    else:  # ASTM D341 through the two points of its definition
        B = np.log10(np.log10(140.7) / np.log10(14.2)) / np.log10(373.15 / 313.15)
        npt.assert_allclose(fit.constants["B"], B, rtol=1e-7)
        npt.assert_allclose(
            fit.constants["A"], np.log10(np.log10(140.7)) + B * np.log10(313.15), rtol=1e-7
        )


@pytest.mark.parametrize("law", ["vogel", "walther"])
def test_standard_deviations_cover_the_law(law):
    """Errors of 1 % in 7 points; the law at 303 K lies within 1 and 1.96 std as often as it should.

    Without a stated error the pulls have Student's distribution of 4 or 5 degrees of freedom. The
    bounds are three standard deviations of a binomial share of 200.
    """
    rng = np.random.default_rng(7)
    true = law_of(law, 303.0)
    stated, unstated = [], []
    for k in range(200):
        noisy = law_of(law) * np.exp(0.01 * rng.normal(size=T.size))
        fit = fit_viscosity(T, viscosities=noisy, law=law, relative_std=0.01)
        found = fit.viscosity(303.0)
        stated.append((found.value - true) / found.std)
        half = np.log(
            fit.interval(303.0).upper / found.value
        )  # a normal one, as the error is known
        npt.assert_allclose(half, 1.959964 * found.std / found.value, rtol=1e-6)
        # the scatter takes the place of the stated error, and all else is the same
        unstated.append(stated[-1] * 0.01 / fit.scatter)
        if k < 5:
            alone = fit_viscosity(T, viscosities=noisy, law=law).viscosity(303.0)
            npt.assert_allclose((alone.value - true) / alone.std, unstated[-1], rtol=1e-5)
    freedom = T.size - len(fit.constants)
    student = {1.0: [0.626, 0.637][freedom - 4], 1.96: [0.878, 0.893][freedom - 4]}
    for pulls, within in ((stated, {1.0: 0.683, 1.96: 0.950}), (unstated, student)):
        for width, share in within.items():
            bound = 3 * np.sqrt(share * (1 - share) / len(pulls))
            assert abs(np.mean(np.abs(pulls) < width) - share) < bound


def test_intervals_hold_the_law_with_few_points():
    """Five points of Vogel's law, 2 degrees of freedom: 1.96 std hold 81 %, Student's factor 95 %.

    The bounds are three standard deviations of a binomial share of 200.
    """
    rng, few = np.random.default_rng(11), slice(1, 6)
    true = vogel_viscosity(303.0, a=6e-5, b=950.0, c=178.0)
    held, narrow = [], []
    for _ in range(200):
        noisy = law_of("vogel")[few] * np.exp(0.01 * rng.normal(size=5))
        fit = fit_viscosity(T[few], viscosities=noisy)
        lower, upper = fit.interval(303.0)
        held.append(lower < true < upper)
        value, std = fit.viscosity(303.0)
        narrow.append(abs(np.log(value / true)) < 1.96 * std / value)
    assert fit.degrees_of_freedom == 2
    # Student's distribution of 2 degrees of freedom in closed form: x / sqrt(2 + x^2)
    for hits, share in ((held, 0.95), (narrow, 1.96 / np.sqrt(2 + 1.96**2))):
        assert abs(np.mean(hits) - share) < 3 * np.sqrt(share * (1 - share) / len(hits))


@pytest.mark.parametrize(
    ("grade", "lowest", "highest"),
    [(20, 6.9, 9.3), (30, 9.3, 12.5), (50, 16.3, 21.9), (60, 21.9, 26.1)],
)
def test_engine_oils_lie_in_their_grade_at_100_degrees(grade, lowest, highest):
    """SAE J300, kinematic viscosity at 100 degrees; densities of 820 to 850 kg/m3 when hot."""
    hot = vogel_viscosity(373.15, **sae_oil(grade)._asdict())
    assert lowest < hot / 850 * 1e6
    assert hot / 820 * 1e6 < highest


def test_engine_oil_is_the_printed_formula():
    """SAE 30: 0.0141 exp(1360 / (T + 95)) microreyn at 140 degrees Fahrenheit."""
    printed = 0.0141e-6 * 6894.757 * np.exp(1360.0 / 235.0)
    npt.assert_allclose(vogel_viscosity(333.15, **sae_oil(30.0)._asdict()), printed, rtol=1e-5)


def test_grades_of_iso():
    npt.assert_allclose(iso_vg_viscosity(46.0), (41.4e-6, 50.6e-6))
