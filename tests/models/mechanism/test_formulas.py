"""What the methods of both linkages share: kinds of arguments, units, bad values."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import ModelError, UnitWarning
from erlif.models.mechanism import CrankRocker, SliderCrank, crank_for_swing

RIG = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)  # Farzaneh (2002), A.2
MUKRAS = SliderCrank(crank=0.0762, coupler=0.2032)  # Mukras et al. (2008), Table 1 doubled
TURN = np.linspace(0, 2 * np.pi, 721)


def test_a_data_array_keeps_its_coordinates():
    crank_angle = xr.DataArray(TURN, dims="frame", coords={"frame": np.arange(TURN.size)})
    psi = RIG.rocker_angle(crank_angle)
    rising = RIG.rocker_speed(crank_angle, crank_speed=1.0) > 0
    back = RIG.crank_angle(psi, rising=rising)
    assert isinstance(back, xr.DataArray)
    assert back.dims == ("frame",)
    npt.assert_allclose(np.cos(back - crank_angle), 1, atol=1e-9)
    assert isinstance(MUKRAS.slider_acceleration(crank_angle, crank_speed=1.0), xr.DataArray)


def test_lengths_in_millimetres_warn():
    for length, build in (
        ("crank = 55 m", lambda: CrankRocker(crank=55, coupler=440, rocker=260, ground=510)),
        ("coupler = 203.2 m", lambda: SliderCrank(crank=76.2, coupler=203.2)),
        ("ground = 510 m", lambda: crank_for_swing(0.4, coupler=440, rocker=260, ground=510)),
    ):
        with pytest.warns(UnitWarning) as caught:
            build()
        assert any(str(one.message).startswith(f"{length} is implausible") for one in caught)


POSITIONS = ["rocker_angle", "coupler_angle", "transmission_angle"]


SPEEDS = ["rocker_speed", "coupler_speed", "rocker_acceleration"]


SLIDER_POSITIONS = ["coupler_angle", "slider_position", "joint_angle"]


SLIDER_SPEEDS = [
    "coupler_speed",
    "slider_speed",
    "joint_speed",
    "coupler_acceleration",
    "slider_acceleration",
]


METHODS = [
    *((RIG, name, {}) for name in POSITIONS),
    *((RIG, name, {"crank_speed": 3}) for name in SPEEDS),
    *((MUKRAS, name, {}) for name in SLIDER_POSITIONS),
    *((MUKRAS, name, {"crank_speed": 3}) for name in SLIDER_SPEEDS),
]


@pytest.mark.parametrize(("linkage", "name", "speed"), METHODS)
def test_scalars_give_floats_and_sequences_give_the_same_values(linkage, name, speed):
    method = getattr(linkage, name)
    one, two = method(1, **speed), method(np.float64(2.0), **speed)
    assert type(one) is type(two) is float
    for crank_angle in ([1, 2], (1.0, 2.0), range(1, 3), np.array([1, 2])):
        npt.assert_allclose(method(crank_angle, **speed), [one, two], rtol=1e-12)


@pytest.mark.parametrize(("linkage", "name", "speed"), METHODS)
def test_infinite_angles_and_speeds_are_refused_by_name(linkage, name, speed):
    with pytest.raises(ModelError, match="crank_angle must be finite"):
        getattr(linkage, name)([1.0, np.inf], **speed)
    for argument in speed:
        with pytest.raises(ModelError, match=f"{argument} must be finite"):
            getattr(linkage, name)(1.0, **{argument: np.inf})
    if name.endswith("acceleration"):
        with pytest.raises(ModelError, match="crank_acceleration must be finite"):
            getattr(linkage, name)(1.0, **speed, crank_acceleration=-np.inf)


def test_inverse_maps_take_lists_and_give_floats_for_scalars():
    psi = RIG.rocker_angle([1.0, 4.0])
    npt.assert_allclose(RIG.crank_angle(list(psi), rising=[False, True]), [1.0, 4.0], rtol=1e-9)
    assert type(RIG.crank_angle(psi[0], rising=False)) is float
    phi = RIG.coupler_angle(1.0)
    assert type(RIG.crank_angle_from_coupler(phi, rising=False)) is float
    x = MUKRAS.slider_position([1.0, 4.0])
    found = MUKRAS.crank_angle_from_slider(list(x), rising=[False, True])
    npt.assert_allclose(found, [1.0, 4.0], rtol=1e-9)
    assert type(MUKRAS.crank_angle(MUKRAS.coupler_angle(1.0), rising=False)) is float
