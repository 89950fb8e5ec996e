"""What a command has printed, without the breaks of long lines."""

import re


def unwrapped(text):
    """Join the lines that were broken; what follows a break is indented."""
    return re.sub(r"\n +", " ", text)


def line_of(text, title):
    """The text behind a title."""
    (line,) = [line for line in text.splitlines() if line.startswith(f"  {title} ")]
    return line.removeprefix(f"  {title}").strip()
