"""The command line as a whole: help, loading, exit status."""

import logging
import os
import re
import subprocess
import sys
import warnings

import click
import pytest
from click.testing import CliRunner

import erlif
import erlif.pipeline
from erlif.commands.main import main, show_log
from erlif.commands.options import QuantityOption
from erlif.core.errors import ErlifError, UnitWarning

COMMANDS = sorted(main.commands)


def test_importing_erlif_loads_nothing_heavy():
    """Help and completion must not wait for figures, kernels and file formats."""
    loading = "import sys, erlif, erlif.commands.main"
    script = f"{loading}; print(*{{name.split('.')[0] for name in sys.modules}})"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.split())
    assert "erlif" in loaded
    # threads of numpy are set before it is loaded
    heavy = "numpy matplotlib dask panel numba scipy xarray pandas cv2 zarr h5py pint skimage"
    assert not loaded & set(heavy.split())


def test_help_fits_one_screen_and_lists_every_command_in_one_line():
    shown = CliRunner().invoke(main, ["--help"], terminal_width=80).output.splitlines()
    assert len(shown) <= 40
    assert max(map(len, shown)) <= 80
    listed = [line.split()[0] for line in shown if line[:3].strip() and line.startswith("  ")]
    assert set(COMMANDS) <= set(listed)
    assert not [line for line in shown[1:] if line.endswith("...")]


OPTIONS = [
    (name, option)
    for name, each in main.commands.items()
    for option in each.params
    if isinstance(option, click.Option)
]

# Options of a number without a dimension, and those whose name is a unit.
NUMBERS = {
    *("dpi", "fps", "ratio", "time-ratio", "torque-ratio", "least-rise", "exponent", "light"),
    *("torque-std", "load-std", "radius-std", "background", "background-beam"),
    *("elapsed", "pulses-per-cycle"),  # turns, and frames in a turn
    "vibration",  # pixels
}


def test_a_value_with_a_dimension_is_a_quantity_with_its_unit():
    for name, option in OPTIONS:
        flag = option.opts[-1].removeprefix("--")
        if isinstance(option.type, QuantityOption):
            with pytest.raises(click.BadParameter, match="a number with a unit"):
                option.type.convert("5", option, None)
            five = option.type.convert(f"5 {option.type.unit}", option, None)
            assert five == pytest.approx(5.0), (name, flag)
        elif isinstance(option.type, type(click.FLOAT)):
            assert flag in NUMBERS, (name, flag)
        unit = r"\bin (um|mm|N|N/m|Pa s|kPa|MB|degrees?)\b"
        assert not re.search(unit, option.help or ""), (name, flag)


def test_options_have_one_name_for_one_thing():
    for name, option in OPTIONS:
        assert not {flag.removeprefix("--") for flag in option.opts} & set(COMMANDS), name
        assert "--trigger" in option.opts or "trigger" not in str(option.opts), name
        if "-o" in option.opts:
            assert option.opts == ["-o", "--output"]
            assert "; default: " in option.help, name
            assert option.type.name == "path"


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_fits_40_lines_of_80_columns(name):
    shown = CliRunner().invoke(main, [name, "--help"], terminal_width=80).output.splitlines()
    assert len(shown) <= 40
    assert max(map(len, shown)) <= 80


def test_help_of_a_command_of_many_options_has_all_of_them_on_request():
    texts = [
        CliRunner().invoke(main, [*more, "simulate", "--help"]).output for more in ((), ("-v",))
    ]
    options = [each.opts[-1] for each in main.commands["simulate"].params][1:]
    few, all_of_them = ([each for each in options if f"{each} " in text] for text in texts)
    assert all_of_them == options
    count = len(options) - len(few)
    assert f"{count} more options: erlif -v simulate --help" in texts[0]


def test_the_option_for_more_lines_stands_before_or_behind_the_command(lab, command):
    before, behind = command("-v", "check", lab.run), command("check", lab.run, "-v")
    plain = command("check", lab.run)
    assert before.stdout == behind.stdout
    assert len(plain.stdout.splitlines()) < len(behind.stdout.splitlines())
    assert len(plain.stderr.splitlines()) < len(behind.stderr.splitlines())


def test_the_version_is_that_of_the_package(command):
    assert erlif.__version__ in command("--version").stdout


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (ZeroDivisionError("a slip"), 1, ("a slip", "please report it")),
        (
            PermissionError(13, "Permission denied", "film.nc"),
            2,
            ("Permission denied: film.nc. The previous output is intact. Check",),
        ),
    ],
)
def test_a_defect_of_ours_and_a_refusal_of_the_system_have_a_next_step(
    lab, monkeypatch, command, error, status, words
):
    def fail(*arguments, **options):
        raise error

    monkeypatch.setattr(erlif.pipeline, "process", fail)
    message = command("process", lab.run, status=status).stderr
    assert all(word in message for word in words)


def test_a_warning_of_a_model_is_one_line_without_a_place_in_the_code(lab, command, monkeypatch):
    def process(*args, **options):
        for _ in range(3):
            warnings.warn("viscosity = 120 Pa s is implausible", UnitWarning, stacklevel=1)
            warnings.warn("overflow", RuntimeWarning, stacklevel=1)
        raise ErlifError("the end")

    monkeypatch.setattr(erlif.pipeline, "process", process)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        lines = command("process", lab.run, status=2).stderr.splitlines()
    assert lines.count("  warning: viscosity = 120 Pa s is implausible") == 1
    (other,) = [line for line in lines if "overflow" in line]
    assert "test_main.py" in other


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("4", "4")])
def test_linear_algebra_has_one_thread_unless_the_user_chooses(monkeypatch, given, used):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "unset")  # restored after the test
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    else:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", given)
    CliRunner().invoke(main, ["process", "--help"])
    assert os.environ["OPENBLAS_NUM_THREADS"] == used


@pytest.fixture(autouse=True)
def _quiet_afterwards():
    yield
    show_log(0)


@pytest.mark.parametrize(
    ("verbosity", "shown"),
    [(0, {"w"}), (1, {"w", "i"}), (2, {"w", "i", "d"}), (5, {"w", "i", "d"})],
)
def test_each_v_shows_one_level_more(capsys, verbosity, shown):
    show_log(verbosity)
    logger = logging.getLogger("erlif.registration.estimate")
    logger.warning("w")
    logger.info("i")
    logger.debug("d")
    lines = capsys.readouterr().err.splitlines()
    assert {line.rpartition(": ")[2] for line in lines} == shown
    assert all((" s  registration.estimate: " in line) == (verbosity > 0) for line in lines)


def test_a_line_is_written_once_however_often_the_log_is_set_up(capsys):
    for _ in range(3):
        show_log(1)
    logging.getLogger("erlif.ratio").info("blur")
    assert capsys.readouterr().err.count("blur") == 1
