"""The lines for the terminal: numbers of the film in plain words."""

import numpy as np
import pytest
from scenes import film as scene
from scenes.terminal import line_of

from erlif.show.report import summarise, summarise_briefly, summarise_in_a_line


def test_thickness_is_given_over_the_cycle(film):
    minimum = scene.minimum_film()
    thin, thick = int(minimum.argmin()), int(minimum.argmax())
    text = summarise(film.assign_attrs(notes="one\ntwo"))
    first, *_, one, two = text.splitlines()
    assert first == "a film <known> & small: 6 triggers from 6 frame pairs of 80 x 64 pixels"
    assert one.index("one") == two.index("two")  # notes stand below each other
    low, high = minimum[thin], minimum[thick]
    ends = f"{low:.2f} ± 0.03 um (trigger {thin})", f"{high:.2f} ± 0.03 um (trigger {thick})"
    assert line_of(text, "minimum film thickness") == " to ".join(ends)
    line = summarise_in_a_line(film)
    assert line.startswith(f"min {low:.2f} ± 0.03 to {high:.2f} ± 0.03, mean ")
    assert line.endswith(
        " um, power n = 0.600 ± 0.010, 6 triggers from 6 frame pairs of 80 x 64 pixels"
    )
    warned = summarise(film.assign_attrs(notes="warning: log: odd\none")).splitlines()
    assert warned[1].split() == ["warnings", "log:", "odd"]
    assert warned[-1].split() == ["notes", "one"]
    text = summarise(film.isel(trigger=[0]))
    assert ": 1 trigger from 1 frame pair of" in text
    assert " to " not in line_of(text, "minimum film thickness")


def test_displacement_of_the_pin_is_given_over_the_cycle(film):
    """Towards the load the clearance less the film, with 3 and 15 nm; sideways 40 and 30 nm."""
    load = 230.0 - scene.minimum_film()
    side = 0.2 / np.sqrt(33.36 * 33.59) * load
    assert line_of(summarise(film), "displacement of the pin") == (
        f"{load.min():.2f} to {load.max():.2f} ± 0.02 um towards the load, "
        f"{side.min():.2f} to {side.max():.2f} ± 0.05 um sideways, "
        "about the load line at 7.90 mm"
    )
    assert "displacement of the pin" not in summarise(film.drop_vars("pin_displacement"))
    assert "displacement of the pin" not in summarise(scene.without_valid_pixels(film))


def test_a_power_that_is_not_known_is_given_in_words(film):
    """First the mean film has no power, then the power of the minimum no error."""
    unknown = film.assign(
        speed_exponent_mean=film.speed_exponent_mean * np.nan,
        speed_exponent_mean_std=film.speed_exponent_mean_std * np.nan,
    )
    line = line_of(summarise(unknown), "power of speed over load")
    assert line == "minimum n = 0.600 ± 0.010, mean not determined"
    unknown = film.assign(speed_exponent_std=film.speed_exponent_std * np.nan)
    line = line_of(summarise(unknown), "power of speed over load")
    assert line.startswith("minimum n = 0.600, error unknown, mean n = 0.400 ± 0.010")
    assert "nan" not in summarise_in_a_line(unknown)


def test_theory_is_that_of_the_highest_speed(film):
    speeds = scene.rocker_speed(scene.CRANK)
    top = int(np.abs(speeds).argmax())
    steady = film.drop_vars("film_predicted_min")
    theory = line_of(summarise(steady), "theory at the top speed")
    assert theory.startswith(f"{20 * scene.minimum_film()[top]:.3g} um, isoviscous-rigid")
    assert f"({0.03336 * abs(speeds[top]):.3f} m/s, 222 N)" in theory
    assert theory.endswith(
        f"Hamrock-Dowson, line contact (2.65): {0.3 * scene.minimum_film()[top]:.3g} um"
    )
    assert "the largest governs" in summarise(steady)


def test_film_without_valid_pixels_is_described(film):
    text = summarise(scene.without_valid_pixels(film))
    none = "none: no trigger has enough valid pixels in the region of interest"
    assert line_of(text, "minimum film thickness") == none
    assert line_of(text, "valid pixels") == "0.0%"
    empty = film.assign(film_min=film.film_min * np.nan, speed_exponent=np.nan)
    none = "none: no smooth gap describes the maps, or too few of their pixels are valid"
    assert line_of(summarise(empty), "minimum film thickness") == none
    line = summarise_in_a_line(empty)
    assert line.startswith("min none, mean ")
    assert " um, power not determined, 6 triggers" in line


def test_a_mean_over_a_part_of_the_region_is_described_as_such(film):
    shares = np.zeros(film.sizes["trigger"])
    shares[int(np.argmin(film.film_mean.values))] = 0.28
    film = film.copy()
    film["share_beyond_range"] = ("trigger", shares)
    text = line_of(summarise(film), "mean film thickness")
    assert text.count("over the 72% of the region within the calibrated range") == 1


def with_agreement(film):
    """A film with all that a summary says of speed and theory, in numbers of five digits."""
    attrs = dict.fromkeys(("low", "high", "outward", "back"), 1.2346)
    attrs |= {"factor": 1.2346, "factor_std_random": 0.0123, "factor_std_shared": 0.0456}
    attrs |= {"viscosity": 0.12345, "viscosity_std": 0.0123, "viscosity_given": 0.12}
    attrs |= {"formula_error": 0.2, "viscosity_std_formula": 0.03}
    table = ("correlated_film", "correlated_with"), np.full((3, 2), -0.123)
    names = [f"speed_correlation{part}" for part in ("_rank", "", "_low", "_high")]
    return film.assign(dict.fromkeys(names, table)).assign(
        film_over_hamrock_dowson=("trigger", np.ones(film.sizes["trigger"]), attrs),
        correlated_film=["film_min", "film_mean", "film_gap_mean"],
        correlated_with=["speed", "speed over load"],
        speed_delay=-12.3,
        speed_delay_std=2.3,
    )


def test_a_short_summary_has_ten_lines_and_one_for_each_warning(film):
    """Twelve with the lines of files and of the next command, and no sentence is cut."""
    sentence = "Squeeze carries the film of a free pin (very strong: BIC 457 below any guided pin)"
    noted = with_agreement(film).assign_attrs(
        notes="warning: camera1: first; why. Cure.\nwarning: camera2: second. Cure.\none",
        physics=f"{sentence}. Advice.",
        largest_error="wall: 9 nm. x",
    )
    outside = noted.copy()
    outside.film_over_hamrock_dowson.attrs["formula_error"] = np.inf
    flat = outside.assign(film_central=2 * film.film_min, film_central_std=film.film_min_std)
    central = outside.film_over_hamrock_dowson.assign_attrs(factor=0.987)
    flat = flat.assign(film_central_over_theory=central, film_over_theory=central)
    flat = flat.assign_attrs(contact="plateau")
    named = {"formula": "h/Rx", "long_name": "Hamrock-Dowson, elliptical"}
    formula = flat.film_hamrock_dowson.assign_attrs(named)
    flat = flat.assign(film_hamrock_dowson=formula)
    assert "h_c" in line_of(summarise_briefly(flat), "film")
    assert "mean" not in line_of(summarise_briefly(flat), "film")
    for shown in (
        film,
        noted,
        outside,
        flat,
        scene.without_valid_pixels(noted),
        noted.isel(trigger=[0]),
    ):
        lines = summarise_briefly(shown).splitlines()
        warned = str(shown.attrs.get("notes", "")).count("warning: ")
        assert len(lines) <= 10 + warned
        assert max(map(len, lines)) <= 80
    long = film.assign_attrs(title=f"oil-film thickness, {'a long name ' * 9}")
    assert len(summarise_briefly(long).splitlines()[0]) == 80
    text = summarise_briefly(noted)
    assert line_of(text, "warning") == "camera1: first"
    assert "camera2: second" in text
    assert line_of(text, "error") == "wall: 9 nm"
    assert sentence in " ".join(text.split())
    assert "Cure" not in text


def test_film_over_hamrock_dowson_and_its_correlation_are_stated(film):
    text = " ".join(summarise_briefly(with_agreement(film)).split())
    factor = "1.235 ± 0.012 ± 0.046 × Hamrock-Dowson, line contact (2.65) ± 20 %"
    assert f"{factor}; 1.23 to 1.23, out 1.23, back 1.23" in text
    assert "back 1.23; takes 0.12 ± 0.03, oil 0.12 Pa s" in text
    assert "correlation -0.12 (-0.12 to -0.12), rank -0.12; of the mean -0.12" in text
    assert "n = 0.600 ± 0.010, mean n = 0.400 ± 0.010; 12.3 ± 2.3° early" in text
    whole = summarise(with_agreement(film))
    assert line_of(whole, "correlation with the speed").startswith("speed: film_min -0.12 (-0.12")


def test_each_end_of_a_range_has_its_own_error(film):
    minimum = scene.minimum_film()
    widened = film.assign(film_min_std=0.05 + 0.1 * (film.film_min == film.film_min.max()))
    assert line_of(summarise_briefly(widened), "film").startswith(
        f"min {minimum.min():.2f} ± 0.05 to {minimum.max():.2f} ± 0.15, mean"
    )


@pytest.mark.parametrize(
    ("used", "reason"),
    [(6, "speed over load is constant"), (2, "2 of 6 triggers usable, 5 needed")],
)
def test_an_unknown_power_has_its_reason(film, used, reason):
    """Five triggers are enough for a power, unless their speed is the same."""
    unknown = film.speed_exponent.copy(data=np.nan).assign_attrs(triggers_used=used)
    text = summarise_briefly(film.assign(speed_exponent=unknown))
    assert line_of(text, "speed") == f"not determined: {reason}"
