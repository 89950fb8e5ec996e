"""``erlif report``."""


def test_triggers_and_size_that_are_none_are_refused(lab, refused):
    message = refused("report", lab.film, "--trigger", "5-")
    assert "Expected a trigger or a range of triggers, such as 12 or 100-149" in message
    assert "0.5 MB or more" in refused("report", lab.film, "--max-size", "0 MB")


def test_triggers_of_several_films_are_refused(lab, refused):
    assert "one film" in refused("report", lab.film, lab.film, "--trigger", "0-1", "-o", "a.html")
