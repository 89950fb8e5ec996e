"""``python -m erlif`` is the command ``erlif``."""

from erlif.cli import main

main()
