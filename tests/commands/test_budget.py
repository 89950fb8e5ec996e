"""``erlif budget``."""


def test_a_trigger_that_does_not_exist_is_refused_with_the_range(lab, refused):
    assert "from 0 to 5" in refused("budget", lab.run, "--trigger", 99)


def test_a_target_is_a_share_or_a_length(lab, command, refused):
    shown = command("budget", lab.run, "--target", "1 %").stdout
    assert "Target: " in shown
    assert max(map(len, shown.splitlines())) <= 80
    assert 'Expected a target such as "1 %" of the film' in refused(
        "budget", lab.run, "--target", "1 kg"
    )
