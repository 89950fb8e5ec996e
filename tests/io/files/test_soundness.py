"""Films that no run gives are refused when they are opened."""

import h5py
import numpy as np
import pytest
from scenes.film import make_film

from erlif.core.errors import OutputError
from erlif.core.variables import FRAMES, REGISTRATION
from erlif.io.files import open_film
from erlif.io.files.soundness import check_film, check_frames, check_registration
from erlif.io.settings import OpticsSettings, RunSettings, count_keys
from erlif.show.plots import example_film
from erlif.show.plots.example import write_example


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return make_film(tmp_path_factory.mktemp("film"))


def change(name, values):
    """Give a variable other values, and with them another type or shape."""

    def damage(film):
        kept = film[name]
        return film.assign({name: (kept.dims, np.asarray(values(kept.values)), kept.attrs)})

    return damage


def attribute(name, value, variable=None):
    def damage(film):
        attrs = film.attrs if variable is None else film[variable].attrs
        if value is None:
            del attrs[name]
        else:
            attrs[name] = value
        return film

    return damage


def set_first(number):
    def damage(values):
        changed = values.astype(float)
        changed[0] = number
        return changed

    return damage


def without(name):
    return lambda film: film.drop_vars(name)


# further films are refused by name in the catalogue of damages
DAMAGES = [
    (without("sliding_speed"), "film_theory and no variable sliding_speed"),
    (without("rocker_speed"), "it has a linkage and no variable rocker_speed"),
    (lambda film: film.assign(joint_load=("x", film.x.values)), "joint_load has the dims"),
    (lambda film: film.isel(trigger=slice(0, 0)), "trigger has no values"),
    (change("joint_load", lambda v: v.astype(str)), "joint_load has values of the type"),
    (change("film_min_std", set_first(-0.1)), r"film_min_std has the value -0\.1"),
    (change("y", lambda v: v**2), "its positions y have unequal distances"),
    (attribute("notes", 1.5), r"its attribute notes is 1\.5, not text"),
    (attribute("input_hashes", '{"run.toml": 5}'), "input_hashes holds other values"),
    (attribute("triggers_used", None, "speed_exponent"), "triggers_used of speed_exponent is"),
    (attribute("log_scale", np.inf, "speed_exponent"), "log_scale of speed_exponent is"),
]


def test_a_film_that_no_run_gives_is_refused():
    for damage, words in DAMAGES:
        with pytest.raises(ValueError, match=words):
            check_film(damage(example_film()))


@pytest.mark.parametrize("later", [True, False])
def test_a_key_of_a_later_erlif_names_its_version_and_one_of_this_is_damage(tmp_path, later):
    known = count_keys(RunSettings)
    path = write_example(tmp_path / "film.nc")
    with h5py.File(path, "r+") as file:
        text = file.attrs["settings"]
        file.attrs["settings"] = "new_key = 3\n" + getattr(text, "decode", lambda: text)()
        file.attrs["settings_version"] = known + later
        file.attrs["erlif_version"] = "0.3.0"
    words = f"later .* 0\\.3\\.0: its settings have version {known + 1}.*up to {known}"
    with pytest.raises(OutputError, match=words if later else "is damaged.*cannot be read"):
        open_film(path)


def test_the_version_of_settings_rises_with_a_key_in_any_table(monkeypatch):
    known = count_keys(RunSettings)
    fields = OpticsSettings.model_fields | {"new_key": OpticsSettings.model_fields["x_axis"]}
    monkeypatch.setattr(OpticsSettings, "__pydantic_fields__", fields)
    assert count_keys(RunSettings) == known + 1


def test_what_could_not_be_measured_is_nan_and_accepted():
    film = example_film()
    for name in ("film_min", "film_mean", "film_theory", "speed_exponent"):
        film[name] = film[name] * np.nan
        film[name].attrs.update(example_film()[name].attrs)
    check_film(film)


def test_a_group_of_a_film_is_checked_as_well(whole):
    for group, check, forms in (
        ("frames", check_frames, FRAMES),
        ("registration", check_registration, REGISTRATION),
    ):
        with open_film(whole, group=group) as found:
            for name in (name for name, form in forms.items() if form.required):
                with pytest.raises(ValueError, match=f"it has no variable {name}"):
                    check(found.drop_vars(name))
