"""Exit status of each kind of failure."""

BAD_INPUT = 2
"""Exit status where the input or the usage is at fault."""

DEFECT = 1
"""Exit status where erlif is at fault."""

BY_SIGNAL = 128
"""Exit status after a signal, as shells expect it, less the number of the signal."""

INTERRUPTED = BY_SIGNAL + 2
"""Exit status after Ctrl-C."""
