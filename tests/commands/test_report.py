"""``erlif report``."""


def test_triggers_and_size_that_are_none_are_refused(lab, refused):
    message = refused("report", lab.film, "--triggers", "5")
    assert "Expected triggers FROM-TO as in 100-149" in message
    assert "0.5 MB or more" in refused("report", lab.film, "--max-size", "0")


def test_triggers_of_several_films_are_refused(lab, refused):
    assert "one film" in refused("report", lab.film, lab.film, "--triggers", "0-1", "-o", "a.html")
