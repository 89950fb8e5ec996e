"""Camera and purpose of image files by their names.

Laboratories name their files in many ways. The camera of a file is taken from a camera number in
its name ("Camera_2", "C1_0001.tif"), else from a wavelength ("610/", "frame_580nm_3.tif"), else
from its folder ("left/"), else from the text before the frame number ("left_0001.tif").
"""

from __future__ import annotations

import glob
import os
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from erlif.io.ingest.images import match_files
from erlif.io.ingest.order import split_name

# Share of the frames that a way of naming must explain; the rest are other images, of a scale.
COVERED = 0.8

# Words in the names of images that are no frames, by their purpose.
PURPOSES = {
    "darks": re.compile(r"(?<![a-z])(dark|dunkel|bias|black)"),
    "flats": re.compile(r"(?<![a-z])(flat|white|uniform)"),
    "backgrounds": re.compile(r"(?<![a-z])(background|bg|dry)(?![a-z])"),
}

# Words in the names of recordings and folders of a fixture.
FIXTURE = re.compile(r"(?<![a-z])(wedge|keil|calib|kalib|fixture)")

# Words in the names of images that show what is excluded.
MASK = re.compile(r"(?<![a-z])mask[es]?(?![a-z])")

_CAMERA = re.compile(
    r"(?<![a-z])(?:camera|kamera|cam|channel|ch|c)[ _-]?0?([0-9])(?!\d)"
    r"|(?<![a-z])(?:camera|kamera|cam)[ _-]?([ab])(?![a-z\d])"
)
_WAVELENGTH = re.compile(r"(?<!\d)([4-8]\d\d)(?=[ _-]?nm|[^a-z\d]|$)")  # visible light, in nm

# Files of one camera by their purpose: "frames", or a key of PURPOSES.
Group = dict[str, list[Path]]

# From the name of a file, relative and in lower case, to the camera it belongs to.
_KeyRule = Callable[[str], str | None]


def lower_name(path: Path, directory: Path) -> str:
    """Name in the directory, its words apart."""
    return split_words(path.relative_to(directory).with_suffix("").as_posix())


def split_words(name: str) -> str:
    """A name in lower case and with "Cam1Dark" written as "cam1_dark"."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def purpose_of(name: str) -> str:
    """What an image is for: "frames" where its name has no word for anything else."""
    purposes = (purpose for purpose, words in PURPOSES.items() if words.search(name))
    return next(purposes, "frames")


def group_by_camera(names: Mapping[Path, str]) -> tuple[dict[str, Group], list[Path]]:
    """Files by camera and purpose, and those of no camera.

    Parameters
    ----------
    names : mapping
        Plain name of each file.

    Returns
    -------
    (dict, list)
        Cameras by their labels, and files that belong to none.

    Examples
    --------
    >>> names = {Path(f"{one}.tif"): one for one in ("c1_0", "c1_1", "c2_0", "c2_dark")}
    >>> groups, _ = group_by_camera(names)
    >>> {label: [len(files) for files in one.values()] for label, one in groups.items()}
    {'camera 1': [2], 'camera 2': [1, 1]}
    """
    purposes = {path: purpose_of(name) for path, name in names.items()}
    rule = _choose_rule([name for path, name in names.items() if purposes[path] == "frames"])
    groups: dict[str, Group] = {}
    unassigned: list[Path] = []
    for path, name in names.items():
        if purposes[path] == "frames":
            label = rule(name)
            if label is None:
                unassigned.append(path)
            else:
                groups.setdefault(label, defaultdict(list))["frames"].append(path)

    # darks and flats may lie elsewhere, "darks/left.tif", "dark_left.tif": there the label, or a
    # word of the names of one camera alone, is looked for in the name
    words = {one: _words(one) for one in groups}
    common = set.intersection(*words.values()) if words else set()
    for path, name in names.items():
        if purposes[path] == "frames":
            continue
        label = rule(name)
        named = [one for one in groups if (words[one] - common) & _words(name)]
        named = named or [one for one in groups if one in name]
        if label not in groups and len(named) == 1:
            label = named[0]
        (groups[label][purposes[path]] if label in groups else unassigned).append(path)
    return groups, unassigned


def assign_in_order(
    groups: Mapping[str, Group], unassigned: list[Path], names: Mapping[Path, str]
) -> tuple[str, ...]:
    """Assign two lone sets of darks or flats to the two cameras, in the order of their names.

    The files are moved from `unassigned` into `groups`; the purposes for which this was done are
    returned.
    """
    done = []
    for purpose in ("darks", "flats") if len(groups) == 2 else ():
        lone = {path: names[path] for path in unassigned if purpose_of(names[path]) == purpose}
        rule = _choose_rule(list(lone.values()))
        labels = {path: str(rule(name)) for path, name in lone.items()}
        if len(lone) == 2:  # a file for each camera, whatever they are called
            labels = lone
        if len(set(labels.values())) != 2 or any(group.get(purpose) for group in groups.values()):
            continue
        cameras, sets = (sorted(each, key=split_name) for each in (groups, set(labels.values())))
        for path, label in labels.items():
            groups[cameras[sets.index(label)]][purpose].append(path)
            unassigned.remove(path)
        done.append(purpose)
    return tuple(done)


def common_wavelength(names: Sequence[str]) -> int | None:
    """Wavelength that stands in all names of a camera, if there is exactly one. [nm]"""
    shared = set.intersection(*(set(_WAVELENGTH.findall(name)) for name in names))
    return int(shared.pop()) if len(shared) == 1 else None


def find_pattern(files: Sequence[Path], directory: Path) -> str | None:
    """The shortest pattern that matches these files and no others; None where there is none."""
    if len(files) == 1:
        return glob.escape(files[0].relative_to(directory).as_posix())

    # what the names share: folder, beginning, end and suffix
    common = Path(os.path.commonpath([path.parent for path in files])).relative_to(directory)
    start = glob.escape(common.as_posix()) + "/" if common.parts else ""
    suffixes = {path.suffix for path in files}
    end = suffixes.pop() if len(suffixes) == 1 else ".*"

    prefix = glob.escape(_common_start([path.name for path in files]).rstrip("0123456789"))
    folders = glob.escape(_common_start([path.parent.name for path in files]))
    ending = glob.escape(_common_start([path.stem[::-1] for path in files])[::-1])

    # from the plainest to the most special; darks and flats may lie among the frames
    candidates = ("*", f"{prefix}*", f"{prefix}[0-9]*", "*/*", f"{folders}*/*")
    every = (f"{start}{one}{end}" for one in (*candidates, f"**/{prefix}*", f"*{ending}"))
    wanted = set(files)
    return next((one for one in every if set(match_files(directory, one)) == wanted), None)


def _common_start(texts: Sequence[str]) -> str:
    """Longest text with which all begin."""
    return os.path.commonprefix(texts)  # noqa: RUF071 - letter by letter, as is meant


def _words(name: str) -> set[str]:
    return set(re.findall("[a-z]+", name))


def _choose_rule(names: Sequence[str]) -> _KeyRule:
    """Choose the first naming rule that gives two cameras, else the one that gives fewest."""
    rules = (_camera_number, _wavelength, _folder, _prefix)
    best: _KeyRule = _one_camera
    fewest = 1 << 30
    for rule in rules:
        labels = [label for name in names if (label := rule(name)) is not None]
        groups = len(set(labels))
        if len(labels) < COVERED * len(names) or not groups:
            continue
        if groups == 2:
            return rule
        if groups < fewest:
            best, fewest = rule, groups
    return best


def _camera_number(name: str) -> str | None:
    match = _CAMERA.search(name)
    return f"camera {match[1] or match[2]}" if match else None


def _wavelength(name: str) -> str | None:
    match = _WAVELENGTH.search(name)
    return match[1] if match else None


def _folder(name: str) -> str | None:
    return name.rpartition("/")[0] or None


def _prefix(name: str) -> str | None:
    return re.sub(r"[ _-]*\d+$", "", name) or None


def _one_camera(name: str) -> str | None:
    return "frames"
