"""Impact of a pin in a bushing: the numbers of Mukras et al. (2008), restitution."""

import numpy.testing as npt
import pytest

from erlif.models.contact import contact_modulus, impact_force, impact_stiffness


def test_impact_stiffness_of_mukras():  # Mukras et al. (2008), eq. 13 with Table 2 in GPa
    modulus = contact_modulus(206.8e9, poisson_1=0.29, youngs_2=0.139e9, poisson_2=0.38)
    case = {"bushing_radius": 9.535e-3, "contact_modulus": modulus}
    npt.assert_allclose(impact_stiffness(9.525e-3, **case, as_printed=True), 1.4942e7, rtol=5e-5)
    npt.assert_allclose(impact_stiffness(9.525e-3, **case), 6.5232e8, rtol=5e-5)
    ratio = impact_stiffness(9.525e-3, **case) / impact_stiffness(9.525e-3, **case, as_printed=True)
    npt.assert_allclose(ratio, 43.66, atol=5e-3)


@pytest.mark.parametrize("restitution", [0.9, 0.93, 0.96, 0.99, 1.0])
def test_impact_loses_the_energy_of_its_restitution(restitution):
    """A mass that hits the spring of eq. 12 leaves with nearly the speed of its restitution."""
    from scipy.integrate import solve_ivp

    def motion(_, state):
        force = impact_force(
            state[0], rate=state[1], impact_speed=1.0, stiffness=1.0, restitution=restitution
        )
        return [state[1], -float(force)]

    def apart(_, state):
        return state[0] + 1e-12

    apart.terminal, apart.direction = True, -1
    end = solve_ivp(motion, (0, 10), [0.0, 1.0], events=apart, rtol=1e-9, atol=1e-12).y[1, -1]
    npt.assert_allclose(-end, restitution, atol=(1 - restitution**2) ** 2)
    assert (
        impact_force(-1.0, rate=1.0, impact_speed=1.0, stiffness=1.0, restitution=restitution) == 0
    )
