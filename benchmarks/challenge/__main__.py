"""The whole ERLIF challenge: ten rigs, four methods, the table.

``python -m benchmarks.challenge OUT`` draws the rigs, measures them and prints both tables;
``--page`` writes them into docs/challenge.md. The methods run one after the other in processes of
their own. OpenPIV is needed: ``pip install -e ".[benchmark]"``.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.challenge import methods, rigs, score

PAGE = Path(__file__).parents[2] / "docs" / "challenge.md"


def main() -> None:
    """Draw, measure and score."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--page", action="store_true", help="write the tables into the page")
    options = parser.parse_args()

    start = time.perf_counter()
    rigs.draw_rigs(options.out, list(rigs.RIGS))
    print(f"rigs drawn after {time.perf_counter() - start:.0f} s", flush=True)
    for method in methods.METHODS:
        command = [sys.executable, "-W", "ignore", "-m", "benchmarks.challenge.methods"]
        subprocess.run([*command, method, options.out, *rigs.RIGS], check=True)
    folders = [options.out / "submissions" / method for method in methods.METHODS]
    tables = score.tabulate(options.out / "truth", folders)
    print(f"{tables}\nAll of it took {time.perf_counter() - start:.0f} s.")
    if options.page:
        head, _, rest = PAGE.read_text(encoding="utf-8").partition("<!-- table -->")
        tail = rest.partition("<!-- end of table -->")[2]
        whole = f"{head}<!-- table -->\n{tables}\n<!-- end of table -->{tail}"
        PAGE.write_text(whole, encoding="utf-8")


if __name__ == "__main__":
    main()
