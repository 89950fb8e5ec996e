"""What the methods of both linkages share: kinds of arguments, units, bad values."""

import numpy as np
import numpy.testing as npt
import pytest
import xarray as xr

from erlif.core.errors import UnitWarning
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
