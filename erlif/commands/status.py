"""Exit status of each kind of failure."""

BAD_INPUT = 2
"""Exit status where the input or the usage is at fault."""

DEFECT = 1
"""Exit status where erlif is at fault."""

INTERRUPTED = 130
"""Exit status after Ctrl-C, as shells expect it: 128 and the number of the signal."""
