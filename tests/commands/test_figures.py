"""``erlif figures``."""


def test_a_file_that_is_not_a_film_is_refused(lab, refused):
    assert "does not exist" in refused("figures", lab.film)
    assert "damaged or something else" in refused("figures", lab.run / "run.toml")


def test_a_file_in_place_of_the_output_directory_is_refused(lab, refused):
    message = refused("figures", lab.film, "-o", lab.run / "run.toml")
    assert "run.toml is a file" in message
    assert "-o" in message
