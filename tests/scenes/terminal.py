"""What a command has printed, without the breaks of long lines."""

import re


def unwrapped(text):
    """Join the lines that were broken; what follows a break is indented."""
    return re.sub(r"\n +", " ", text)
