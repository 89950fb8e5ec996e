"""``python -m erlif`` is the command ``erlif``."""

from erlif.commands.main import main

if __name__ == "__main__":
    main()
