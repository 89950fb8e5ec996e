"""Stribeck curve: friction of the film and of the log."""

import matplotlib.pyplot as plt
import numpy as np
import numpy.testing as npt

from erlif.show import plots
from erlif.show.plots.style import MUTED


def with_friction(film, **more):
    """The film with a coefficient of a tenth of its Hersey number in millionths."""
    number = np.array([1.0, 2.0, 3.0, 3.5, 2.5, 1.5])
    columns = {
        "hersey_number": 1e-6 * number,
        "friction_coefficient": 0.1 * number,
        "friction_coefficient_std": 0.01 * number,
        **more,
    }
    return film.assign({name: ("trigger", values) for name, values in columns.items()})


def test_stribeck_curve_has_the_friction_of_the_film_and_of_the_log(film):
    outward, back = plots.stribeck_curve(with_friction(film))
    x, y = (np.concatenate([one.get_data()[axis] for one in (outward, back)]) for axis in (0, 1))
    npt.assert_allclose(y, 0.1 * x)
    assert outward.axes.get_xscale() == outward.axes.get_yscale() == "log"

    # the film carries half of the logged torque
    torque = np.full(6, 0.2)
    logged = with_friction(film, torque_not_film=torque, friction_torque=torque)
    grey = [one for one in plots.stribeck_curve(logged) if one.get_color() == MUTED]
    x, y = (np.concatenate([one.get_data()[axis] for one in grey]) for axis in (0, 1))
    npt.assert_allclose(y, 0.2 * x)


def test_friction_that_no_trigger_has_is_stated(film):
    unknown = np.full(6, np.nan)
    ax = plt.figure().add_subplot()
    assert plots.stribeck_curve(with_friction(film, friction_coefficient=unknown), ax=ax) == []
    assert ax.texts


def test_film_parameter_has_a_panel_where_it_is_known(film):
    known, bare = (with_friction(one) for one in (film, film.drop_vars("film_parameter")))
    assert [len(plots.stribeck_figure(one).axes) for one in (known, bare)] == [2, 1]
