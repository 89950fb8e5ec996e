"""Roots of many equations at once, and results in the kind of their arguments."""

import numpy as np
import numpy.testing as npt
import xarray as xr

from erlif.models.contact.roots import find_roots, like


def test_each_element_has_its_own_root():
    wanted = np.array([[2.0, 3.0], [5.0, 7.0]])
    found = find_roots(lambda x, w: x**2 - w, 0.0, 3.0, wanted)
    npt.assert_allclose(found, np.sqrt(wanted), rtol=1e-13)


def test_a_result_is_of_the_kind_of_its_example():
    loads = xr.DataArray([1.0, 2.0], dims="stage", coords={"stage": [3, 4]})
    assert like(loads, np.array([5.0, 6.0])).sel(stage=4) == 6.0
    assert type(like(1.0, np.array(5.0))) is float
    assert like(np.ones(2), np.array([5.0, 6.0])).tolist() == [5.0, 6.0]
