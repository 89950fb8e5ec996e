"""The example design, with the films of the example plan."""

import pytest

from erlif.planning import WantedFilm
from erlif.planning.design import example_dye_design


@pytest.fixture(scope="package")
def design():
    """Concentrations of the thesis, invented spectra."""
    return example_dye_design()


@pytest.fixture(scope="package")
def film():
    return WantedFilm(2.0, 10.0, (0.1, 18.0))
