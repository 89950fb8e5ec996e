"""``erlif export``: what it writes, what it shows."""

import pytest


@pytest.mark.parametrize(
    ("kind", "name"),
    [("csv", "film.csv"), ("mat", "film.mat"), ("tiff", "film.tif"), ("vtk", "film_vtk")],
)
def test_an_export_lies_beside_its_film(kind, name, own, command):
    assert command("export", own, "--to", kind).stdout.strip() == f"written: {own.parent / name}"
    assert (own.parent / name).exists()


def test_a_chosen_trigger_is_named(own, command):
    shown = command("export", own, "--to", "csv", "--trigger", 3).stdout
    assert shown.startswith("trigger 3, ")
    assert (own.parent / "film_trigger3.csv").is_file()
