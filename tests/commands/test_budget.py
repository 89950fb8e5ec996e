"""``erlif budget``."""


def test_a_trigger_that_does_not_exist_is_refused_with_the_range(lab, refused):
    assert "from 0 to 5" in refused("budget", lab.run, "--trigger", 99)
