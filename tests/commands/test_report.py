"""``erlif report``."""


def test_a_file_that_is_not_a_film_is_refused(lab, refused):
    assert "does not exist" in refused("report", lab.film)
    assert "damaged or something else" in refused("report", lab.run / "run.toml")


def test_an_output_name_of_another_format_is_refused(lab, refused):
    assert "Expected a name in .html" in refused("report", lab.film, "-o", lab.run / "page.pdf")


def test_triggers_and_size_that_are_none_are_refused(lab, refused):
    message = refused("report", lab.film, "--triggers", "5")
    assert "Expected triggers FROM-TO as in 100-149" in message
    assert "0.5 MB or more" in refused("report", lab.film, "--max-size", "0")


def test_triggers_of_several_films_are_refused(lab, refused):
    assert "one film" in refused("report", lab.film, lab.film, "--triggers", "0-1", "-o", "a.html")
