"""The list of the sources of error: every entry is complete, and records and pickles find it."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from erlif.core.terms import PARAMETERS, RISE, SOURCES, TERMS, Acts, Where, keys_in

FILMS = np.array([1.0, 3.0])
WHERE = Where(
    film=FILMS,
    slope=np.array([0.1, 0.05]),
    change=np.array([0.01, 0.02]),
    light=FILMS,
    illumination=1.0,
    one=FILMS,
    two=FILMS,
    unit=(3.0, 2.0),
    level=(0.4, 0.5),
    by_dye_2=FILMS,
    light_by_dye_2=FILMS,
    by_wall=FILMS,
    light_by_share=FILMS,
    light_by_wall=FILMS,
    passed=1.0,
)


@pytest.mark.parametrize("key", SOURCES)
def test_a_source_has_words_and_a_cure_and_describes_its_key(key):
    source = SOURCES[key]
    assert source.what
    assert source.what[0].islower()
    assert source.cure[0].isupper()
    assert not source.cure.endswith(".")
    assert bool(source.__doc__) == bool(source.file)
    assert source.file in ("", "run", "fixture")
    assert source.unit in ("%", "mm")
    assert source.width is None or source.file


def test_every_key_stands_in_one_file():
    assert not set(keys_in("run")) & set(keys_in("fixture"))
    assert "energy" in keys_in("run")  # of the dry joint, whose errors are those of the background


def test_a_name_is_that_of_one_parameter():
    for (_, name), parameter in PARAMETERS.items():
        assert parameter.name == name
    assert len({*PARAMETERS.values()}) == len({name for _, name in PARAMETERS})
    for key, term in TERMS.items():
        assert term.parameters
        assert all((key, one.name) in PARAMETERS for one in term.parameters)


@pytest.mark.parametrize("parameter", dict.fromkeys(PARAMETERS.values()), ids=lambda one: one.name)
def test_a_parameter_has_an_effect_on_each_film_and_is_found_again(parameter):
    for effect in (parameter.of_ratio, parameter.of_light):
        for at in (WHERE, replace(WHERE, place=(FILMS, FILMS))):
            assert np.isfinite(np.broadcast_to(effect(at), FILMS.shape)).all()
    assert np.any(parameter.of_ratio(WHERE))
    assert pickle.loads(pickle.dumps(parameter)) is parameter


def test_what_grows_acts_alike_in_all_terms():
    assert RISE.acts is Acts.RISING
    assert [key for (key, name) in PARAMETERS if name == RISE.name] == [
        "ratio",
        "temperature",
        "bleaching",
        "later",
    ]
