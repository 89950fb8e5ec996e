"""``erlif pressure``: what it writes, what it shows, what it refuses."""

import pytest
from scenes.terminal import unwrapped

from erlif.io.files import open_netcdf

pytestmark = pytest.mark.usefixtures("coarse_pressure")


def test_a_pressure_lies_beside_its_film_and_is_replaced_on_request_only(own, command, refused):
    # six triggers over a part of a turn of a film with cavities
    result = command("pressure", own, status=3)
    first = own.parent / "pressure.nc"
    with open_netcdf(first) as found:
        assert found.attrs["statement"] in unwrapped(result.stdout)
        assert found.sizes["trigger"] == 6
        assert not found.pressure_measured.values.any()
    assert not (own.parent / "pressure.png").exists()
    assert "written: " in result.stdout

    before = first.read_bytes()
    assert "use --overwrite" in refused("pressure", own)
    command("pressure", own, "--overwrite", status=3)
    assert first.read_bytes() == before
