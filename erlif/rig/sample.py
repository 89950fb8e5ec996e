"""The sample run of README: a known film, photographed for a laboratory that states its widths."""

from __future__ import annotations

from pathlib import Path

from erlif.core.progress import ShowProgress
from erlif.rig.directory import simulate
from erlif.rig.settings import RigSettings

# Seed of every sample.
SEED = 2002

# The rig of the sample; small pictures and few reference pages keep it small.
SAMPLE = RigSettings(
    width=256,
    height=208,
    film="reynolds",
    tilt=0.0,
    elapsed=40.0,
    thin_line=0.0,
    fixture_frames=8,
    fixture_after=True,
    dark_pages=6,
    flat_pages=3,
    # what a rig has and its laboratory measures or states
    background=0.01,
    background_pages=4,
    bleaching=(2e-5, 1e-5),
    brightness=(1.0, 1.002),
    wall=(0.0, 0.002),
    write_systematics=False,
)

# What a laboratory states that has photographed the dry joint, and the fixture twice.
_WIDTHS = {
    "run.toml": """
[systematics]
ratio = "0.3 %"
background = "0.2 %"
energy = "1 %"
bleaching = "0.2 %"
temperature = "0.2 %"
wall = "0.5 %"
field = "0.1 %"
linearity = "0.1 %"
lag = "0.1 %"
batch = "0 %"
""",
    "fixture.toml": """
[systematics]
position = "0.01 mm"
size = "0.05 %"
""",
}

# The joint of the rig is as stiff as diamond, that of the sample is acrylic.
_DIAMOND = 'youngs_modulus = "1000 GPa", poissons_ratio = 0.1'
_ACRYLIC = 'youngs_modulus = "2.7 GPa", poissons_ratio = 0.37'


def write_sample(
    out: Path, *, rig: RigSettings = SAMPLE, overwrite: bool = False, progress: ShowProgress = None
) -> Path:
    """Write a sample run with its fixture and its true film.

    Parameters
    ----------
    out : Path
        Directory that receives ``run``, ``fixture``, ``fixture_after`` and ``truth.nc``.
    rig : RigSettings
        The rig of the sample; it writes no systematics of its own.
    overwrite, progress
        As for `erlif.rig.simulate`.

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    OutputError
        If something of these names exists and `overwrite` is not set.
    """
    simulate(out, seed=SEED, rig=rig, overwrite=overwrite, progress=progress)
    for settings in out.glob("*/*.toml"):
        text = settings.read_text(encoding="utf-8").replace(_DIAMOND, _ACRYLIC)
        text = f"{text.rstrip()}\n{_WIDTHS[settings.name]}"
        settings.write_text(text, encoding="utf-8")
    return out
