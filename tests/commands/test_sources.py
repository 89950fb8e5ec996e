"""``erlif sources``."""


def test_the_page_of_the_docs_is_printed(command):
    text = command("sources").stdout
    assert "Farzaneh (2002)" in text
    assert "| place | quantity | printed | erlif |" in text
