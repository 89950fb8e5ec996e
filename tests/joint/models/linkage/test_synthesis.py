"""Synthesis: every solution is measured again from positions, and none is missing."""

import itertools

import numpy as np
import numpy.testing as npt
import pytest

from erlif.core.errors import ModelError
from erlif.joint.models.linkage import measure_linkage, synthesise_crank_rocker

MODULE = "erlif.joint.models.linkage.synthesis"
NAMES = ("crank", "coupler", "rocker", "ground")
RIG = {"crank": 0.055, "coupler": 0.44, "rocker": 0.26, "ground": 0.51}
RPM = np.pi / 30


def without(links, *unknown):
    return {name: float(length) for name, length in links.items() if name not in unknown}


def lengths_of(design):
    return tuple(vars(design.linkage).values())


def holds(result, links):
    """Whether a linkage is among the solutions."""
    wanted = [links[name] for name in NAMES]
    return any(np.allclose(lengths_of(d), wanted, rtol=1e-6) for d in result.designs)


def roots_for_swing(links, unknown, swing):
    """Lengths of one link that give a swing, from the polynomial of eq. A.1, in ascending order.

    With the cosines p and q of both limits, cos S = p q + sqrt(1 - p2) sqrt(1 - q2) becomes
    p2 + q2 - 2 p q cos S = sin2 S.
    """
    x = np.polynomial.Polynomial([0, 1])
    a, b, c, d = (x if name == unknown else float(links[name]) for name in NAMES)
    p, q = (c**2 + d**2 - (b + sign * a) ** 2 for sign in (-1, 1))
    equation = p**2 + q**2 - 2 * np.cos(swing) * p * q - np.sin(swing) ** 2 * (2 * c * d) ** 2
    found = []
    for root in equation.roots():
        if abs(root.imag) > 1e-9 * abs(root) or root.real <= 0:
            continue
        lengths = {**links, unknown: root.real}
        a, b, c, d = (lengths[name] for name in NAMES)
        shortest, middle, longest = sorted((b, c, d))
        cosines = [(c**2 + d**2 - (b + sign * a) ** 2) / (2 * c * d) for sign in (-1, 1)]
        if not (a < shortest and a + longest < shortest + middle):
            continue
        if abs(np.subtract(*np.arccos(cosines)[::-1]) - swing) < 1e-6:
            found.append(root.real)
    return sorted(found)


def test_all_lengths_of_one_link_for_a_swing_are_found(solver, draw_linkage):
    rng = np.random.default_rng(11)
    several = 0
    for k in range(120):
        links = dict(zip(NAMES, draw_linkage(rng), strict=True))
        one = solver(links.values())
        wanted = one.extreme(one.rocker_angle, 1)[1] - one.extreme(one.rocker_angle, -1)[1]
        unknown = NAMES[k % 4]
        found = synthesise_crank_rocker(swing=wanted, **without(links, unknown))
        lengths = sorted(getattr(design.linkage, unknown) for design in found.designs)
        npt.assert_allclose(lengths, roots_for_swing(links, unknown, wanted), rtol=1e-7)
        several += len(lengths) > 1
        for design in found.designs:
            again = solver(lengths_of(design))
            if np.degrees(design.least_transmission) > 10:
                npt.assert_allclose(again.swing(), wanted, atol=1e-9)
    assert several > 20


def time_ratio_of(links):
    """Of both strokes, from the triangles of the dead points with sides coupler -+ crank."""
    a, b, c, d = links.values()
    excess = np.subtract(*(np.arccos((d**2 + s**2 - c**2) / (2 * d * s)) for s in (b + a, b - a)))
    return (np.pi + abs(excess)) / (np.pi - abs(excess))


@pytest.mark.parametrize("unknown", list(itertools.combinations(NAMES, 2)))
@pytest.mark.parametrize(("target", "seed"), [("speed_ratio", 12), ("time_ratio", 13)])
def test_two_links_for_a_swing_and_a_ratio(solver, draw_linkage, unknown, target, seed):
    """Time ratios are met in both senses."""
    rng = np.random.default_rng([seed, NAMES.index(unknown[0]), NAMES.index(unknown[1])])
    links = dict(zip(NAMES, draw_linkage(rng), strict=True))
    one = solver(links.values())
    swing = one.swing()
    ratio = one.speed_ratio() if target == "speed_ratio" else time_ratio_of(links)
    given = without(links, *unknown)
    found = synthesise_crank_rocker(swing=swing, **{target: ratio}, **given)
    assert holds(found, links)
    for design in found.designs:
        if np.degrees(design.least_transmission) > 25:
            again = solver(lengths_of(design))
            npt.assert_allclose(again.swing(), swing, atol=1e-9)
            if target == "speed_ratio":
                npt.assert_allclose(again.speed_ratio(), ratio, rtol=1e-9)
            else:
                share = again.rising_part()
                measured = max(share, 1 - share) / min(share, 1 - share)
                npt.assert_allclose(measured, ratio, rtol=1e-5)


def test_the_thesis():
    """Farzaneh (2002), A.2: 26 degrees need 5.8484 cm, and 24 rpm need other cranks than 114."""
    links = without(RIG, "crank")
    found = synthesise_crank_rocker(swing=np.radians(26), rocker_speed=24 * RPM, **links)
    (design,) = found.designs
    npt.assert_allclose(design.linkage.crank, 0.058484, atol=5e-7)
    as_built = synthesise_crank_rocker(rocker_speed=24 * RPM, **RIG).designs[0]
    # 114 rpm give 2.552104 rad/s
    npt.assert_allclose(as_built.crank_speed / RPM, 114 * 24 * RPM / 2.552104, rtol=1e-6)


def test_out_of_reach_gives_the_nearest_linkage():
    """Swing of the rig over all cranks: greatest where crank and others fold flat, at 19 cm."""
    found = synthesise_crank_rocker(swing=np.radians(170), **without(RIG, "crank"))
    assert found.designs == ()
    # Grashof: crank below 44 + 26 - 51 cm
    npt.assert_allclose(found.nearest.linkage.crank, 0.19, rtol=1e-6)
    limits = [(0.26**2 + 0.51**2 - (0.44 + s * 0.19) ** 2) / (2 * 0.26 * 0.51) for s in (-1, 1)]
    greatest = np.degrees(np.subtract(*np.arccos(np.clip(limits, -1, 1))[::-1]))
    assert f"nearest: swing {greatest:.3f}"[:-1] in found.statement
    assert "not 170.0000 degrees; all links fold onto one line" in found.statement


def test_more_targets_than_links_are_met_by_least_squares():
    """The printed 26 degrees and 24 of 114 rpm exclude each other with 44, 26 and 51 cm."""
    links = without(RIG, "crank")
    targets = {"swing": np.radians(26), "speed_ratio": 24 / 114}
    found = synthesise_crank_rocker(**targets, **links)
    assert found.designs == ()
    assert len(found.nearest.departures) == 2

    def miss(crank):
        one = synthesise_crank_rocker(crank=crank, **links).designs[0]
        return sum((getattr(one, name) / wanted - 1) ** 2 for name, wanted in targets.items())

    best = found.nearest.linkage.crank
    assert miss(best) < min(miss(best - 1e-5), miss(best + 1e-5))


def test_of_a_family_the_best_transmission_is_chosen():
    """Crank and rocker unknown: the best transmission angle has equal strokes."""
    found = synthesise_crank_rocker(swing=np.radians(26), coupler=0.44, ground=0.51)
    (design,) = found.designs
    a, b, c, d = lengths_of(design)
    npt.assert_allclose(a**2 + d**2, b**2 + c**2, rtol=1e-5)
    npt.assert_allclose(a / c, np.sin(np.radians(13)), rtol=1e-5)
    assert "of a family, the one with the best transmission angle" in found.statement


def test_of_a_family_outside_the_limits_the_nearest_to_them_is_chosen():
    """No linkage with these two links and this swing is as small: the ground link alone is 0.4."""
    found = synthesise_crank_rocker(
        swing=np.radians(60), rocker=0.2, ground=0.4, largest_size=(0.2, 0.1)
    )
    assert "none within the limits; of a family, the one nearest to the limits" in found.statement
    assert any("above 200" in one for one in found.designs[0].departures)


def test_limits_sort_and_shape_the_designs():
    links = without(RIG, "coupler")
    found = synthesise_crank_rocker(
        swing=np.radians(26), least_transmission_angle=np.radians(55), **links
    )
    assert found.statement == "2 crank-rockers meet the targets, 1 within the limits."
    kept, broken = found.designs
    assert kept.departures == ()
    assert broken.departures == ("transmission angle 51.85 degrees, below 55",)

    # a family evades the limit
    size = (0.55, np.inf)
    family = {"swing": np.radians(26), "coupler": 0.44, "rocker": 0.26}
    (free,) = synthesise_crank_rocker(**family).designs
    (held,) = synthesise_crank_rocker(largest_size=size, **family).designs
    assert free.space[0] > 0.55 >= held.space[0] - 1e-9
    npt.assert_allclose(held.space[0], 0.55, rtol=1e-6)
    (wide,) = synthesise_crank_rocker(largest_size=size, link_width=0.03, **family).designs
    npt.assert_allclose(wide.space[0], 0.55, rtol=1e-6)
    centres = measure_linkage(wide.linkage).space
    npt.assert_allclose(wide.space, np.add(centres, 0.03))
    with pytest.raises(ModelError, match="link_width must not be negative"):
        synthesise_crank_rocker(link_width=-0.03, **family)
    tight = synthesise_crank_rocker(largest_size=(0.3, 0.3), **family)
    assert "none within the limits" in tight.statement
    assert "mm along the ground link, above 300" in tight.designs[0].departures[0]


def test_without_a_target_one_link_is_chosen_for_transmission():
    found = synthesise_crank_rocker(**without(RIG, "coupler"))
    (design,) = found.designs
    npt.assert_allclose(design.linkage.coupler, np.sqrt(0.055**2 + 0.51**2 - 0.26**2), rtol=1e-6)


def test_one_length_and_two_targets_give_the_best_of_their_family(monkeypatch):
    """Any length gives the same shape; no ground on a fine grid has a better one."""
    monkeypatch.setattr(f"{MODULE}.SCALES", 9)
    targets = {"swing": np.radians(50), "time_ratio": 1.2}
    shapes = []
    for name in ("rocker", "ground"):
        (best,) = synthesise_crank_rocker(**targets, **{name: 0.26}).designs
        npt.assert_allclose([best.swing, best.time_ratio], [*targets.values()], rtol=1e-8)
        shapes.append(np.array(lengths_of(best)) / best.linkage.rocker)
    npt.assert_allclose(shapes[0], shapes[1], rtol=1e-4)
    others = [
        design.least_transmission
        for ratio in np.linspace(1.0, 1.4, 7)
        for design in synthesise_crank_rocker(**targets, rocker=0.26, ground=0.26 * ratio).designs
    ]
    assert max(others) <= best.least_transmission * (1 + 1e-6)
    assert max(others) > 0.98 * best.least_transmission


def test_a_centric_crank_rocker_of_one_length_has_the_crank_of_the_closed_form(monkeypatch):
    """With equal strokes the pin moves by twice the crank: sin(swing / 2) = crank / rocker."""
    monkeypatch.setattr(f"{MODULE}.SCALES", 9)
    (best,) = synthesise_crank_rocker(swing=np.radians(26), time_ratio=1.0, rocker=0.26).designs
    assert best.linkage.crank == pytest.approx(0.26 * np.sin(np.radians(13)), rel=1e-6)


def test_targets_that_no_scale_meets_are_refused(monkeypatch):
    monkeypatch.setattr(f"{MODULE}.SCALES", 5)
    monkeypatch.setattr(f"{MODULE}._lowest", lambda _, axis, k: axis[k])
    with pytest.raises(ModelError, match="at any ground"):
        synthesise_crank_rocker(swing=np.radians(1), time_ratio=30.0, rocker=0.26)
