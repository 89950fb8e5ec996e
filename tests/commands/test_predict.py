"""``erlif predict``: where it writes, what it shows, what it refuses."""

import re

import pytest


def test_a_prediction_lies_beside_its_film_and_is_replaced_on_request_only(own, command, refused):
    result = command("predict", own)
    first = own.parent / "prediction.nc"
    assert "transient Reynolds, pin free sideways, 6 triggers" in result.stdout
    assert re.search(r"correlation with \|speed\| +measured [+-]\d\.\d\d, predicted", result.stdout)
    assert "written: " in result.stdout
    assert "prediction: 6 done" in result.stderr

    before = first.read_bytes()
    assert "use --overwrite" in refused("predict", own)
    command("predict", own, "--overwrite")
    assert first.read_bytes() == before


@pytest.mark.usefixtures("two_models")
def test_fit_prints_which_physics_carries_the_film(own, command):
    before = set(own.parent.iterdir())
    result = command("predict", own, "--fit")
    assert set(own.parent.iterdir()) == before
    assert "written" not in result.stdout
    assert "BIC" in result.stdout
    assert "a pin that is free sideways" in result.stdout
    # the film of the rig is a power of the speed: no numbers of a model that does not describe it
    assert result.stdout.startswith("No model fits")
    assert "viscosity: " not in result.stdout
