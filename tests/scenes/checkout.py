"""Parts of the repository as a fresh checkout has them."""

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[2]

# what README's first command and those of the pages write beside the frames
WRITTEN = "film*", "figures", "report.html", "prediction.nc", "pressure.*", "calibration.*"


def copy_part(part: str, to: Path) -> None:
    """Copy a directory of the repository without what commands have written into it."""
    shutil.copytree(ROOT / part, to, ignore=shutil.ignore_patterns(*WRITTEN))
