"""Where crank-rockers are: Grashof's condition, from the four lengths alone."""

import itertools

import numpy as np
import pytest

from erlif.joint.models.linkage.domain import EDGE, find_domain

NAMES = ("crank", "coupler", "rocker", "ground")
ONE, TWO = (list(itertools.combinations(NAMES, count)) for count in (1, 2))
RIG = {"crank": 0.055, "coupler": 0.44, "rocker": 0.26, "ground": 0.51}


def is_crank_rocker(crank, *others):
    shortest, middle, longest = sorted(others)
    return bool(crank < shortest and crank + longest < shortest + middle)


@pytest.mark.parametrize("unknown", [*ONE, *TWO])
def test_the_domain_holds_crank_rockers_only(unknown):
    given = {name: length for name, length in RIG.items() if name not in unknown}
    domain = find_domain(given, None)
    axis = np.linspace(1e-6, 1 - 1e-6, 21)
    places = np.array(list(itertools.product(axis, repeat=len(unknown))))
    lengths = np.array(domain.links(places.T)).T
    assert all(is_crank_rocker(*links) for links in lengths)
    for name, length in given.items():
        assert (lengths[:, NAMES.index(name)] == length).all()


@pytest.mark.parametrize("unknown", TWO)
def test_every_crank_rocker_of_the_given_links_is_in_the_domain(unknown):
    rng = np.random.default_rng(5)
    given = {name: length for name, length in RIG.items() if name not in unknown}
    longest = 10 * max(given.values())
    domain = find_domain(given, None)
    axis = np.linspace(EDGE, 1 - EDGE, 401)
    lengths = np.array(domain.links(np.stack(np.meshgrid(axis, axis)))).reshape(4, -1)
    found = lengths[[NAMES.index(name) for name in unknown]]
    count = 0
    for _ in range(300):
        links = RIG | {name: rng.uniform(0, 1.2) for name in unknown}
        if max(links.values()) < longest and is_crank_rocker(*(links[name] for name in NAMES)):
            wanted = np.array([[links[name]] for name in unknown])
            assert np.abs(found - wanted).max(axis=0).min() < 0.02
            count += 1
    assert count > 5
