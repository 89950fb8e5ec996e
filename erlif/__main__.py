"""``python -m erlif`` is the command ``erlif``."""

from erlif.cli import main

if __name__ == "__main__":
    main()
