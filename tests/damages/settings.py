"""Damaged run.toml and fixture.toml, and settings outside physical sense."""

from damages.bench import Damage


def _edit(name, old, new, *words, status=2):
    return Damage(
        f"run.toml: {name}",
        lambda bench: bench.edit(bench.run / "run.toml", (old, new)),
        "process run",
        words,
        status,
    )


def _fixture(name, old, new, *words):
    return Damage(
        f"fixture.toml: {name}",
        lambda bench: bench.edit(bench.fixture / "fixture.toml", (old, new)),
        "calibrate fixture --overwrite",
        words,
    )


def _whole(name, content, *words):
    return Damage(
        f"run.toml: {name}",
        lambda bench: bench.write(bench.run / "run.toml", content),
        "process run",
        words,
    )


PITCH = 'pixel_pitch = "150 um"'
CRANK = 'crank = "5.5 cm"'

SETTINGS = [
    # the file
    _whole("empty", "", "[run]: missing table"),
    _whole("text", "these are no settings", "Expected valid TOML"),
    _whole("binary", bytes(range(256)), "Expected valid TOML"),
    _whole("UTF-16", "[run]\nname = 'a'\n".encode("utf-16"), "Expected valid TOML"),
    _whole("nested without end", "a = " + "[" * 100_000, "Expected valid TOML"),
    _whole("2 MB", "# " + "a" * 2**21, "at most 1 MB are read"),
    _edit("table twice", "[oil]", "[joint]\nload = 1\n[oil]", "Expected valid TOML"),
    _edit("quote left out", '"580 nm"', "580 nm", "Expected valid TOML", "double quotes"),
    _edit("key twice", "bit_depth = 12", "bit_depth = 12\nbit_depth = 12", "valid TOML"),
    # keys
    _edit("key misspelt", "pixel_pitch", "pixel_pich", "did you mean 'pixel_pitch'?"),
    _edit("table misspelt", "[encoder]", "[encodr]", "did you mean 'encoder'?"),
    _edit("foreign key", "[run]", "[run]\nweather = 'fine'", "[run] weather: unknown key"),
    _edit("key left out", PITCH, "", "[optics] pixel_pitch: missing key"),
    _edit("gap left", '"580 nm"', '"?? nm"', "1 gap is left", "band"),
    # types
    _edit("bare number", PITCH, "pixel_pitch = 150", "[optics] pixel_pitch", "150"),
    _edit("list", PITCH, "pixel_pitch = [150]", "[optics] pixel_pitch"),
    _edit("true", PITCH, "pixel_pitch = true", "[optics] pixel_pitch"),
    _edit("date", PITCH, "pixel_pitch = 1979-05-27", "[optics] pixel_pitch"),
    _edit("table for a value", PITCH, 'pixel_pitch = { a = "1 um" }', "[optics] pixel_pitch"),
    _edit("value for a table", "[run]\nname =", "run =", "run: expected a table"),
    _edit("text as depth", "bit_depth = 12", 'bit_depth = "twelve"', "[camera1] bit_depth"),
    _edit("depth of 64", "bit_depth = 12", "bit_depth = 64", "[camera1] bit_depth", "16"),
    _edit("depth of 7", "bit_depth = 12", "bit_depth = 7", "[camera1] bit_depth", "8"),
    _edit("depth with a fraction", "bit_depth = 12", "bit_depth = 12.5", "[camera1] bit_depth"),
    _edit("empty file name", '"camera1/*.tif"', '""', "[camera1] files"),
    _edit("control character in a name", '"camera1/*.tif"', '"a\\u0007"', "[camera1] files"),
    # units and numbers
    _edit("wrong kind of unit", '"150 um"', '"150 N"', "[optics] pixel_pitch", "150 N"),
    _edit("unknown unit", '"150 um"', '"150 furlongs"', "[optics] pixel_pitch", "50 nm to 5 mm"),
    _edit("unit without number", '"150 um"', '"um"', "[optics] pixel_pitch"),
    _edit("NaN", '"150 um"', '"nan um"', "[optics] pixel_pitch"),
    _edit("infinity", '"150 um"', '"inf um"', "[optics] pixel_pitch"),
    _edit("overflow", '"150 um"', '"1e999 um"', "[optics] pixel_pitch"),
    _edit("zero", '"150 um"', '"0 um"', "[optics] pixel_pitch"),
    _edit("negative", '"150 um"', '"-150 um"', "[optics] pixel_pitch"),
    _edit("NaN without quotes", "poissons_ratio = 0.37", "poissons_ratio = nan", "poissons_ratio"),
    _edit("Poisson's ratio above 0.5", "0.37", "0.7", "poissons_ratio", "0.5"),
    _edit("triggers below 1", "triggers_per_cycle = 6", "triggers_per_cycle = 0", "triggers_per"),
    # outside physical sense
    _edit("pitch in mm for um", '"150 um"', '"150 mm"', "[optics] pixel_pitch", "50 nm to 5 mm"),
    _edit("pitch in nm for um", '"150 um"', '"150 nm"', "pixel_pitch"),
    _edit("wavelength in um", '"580 nm"', '"580 um"', "[camera1] band", "200 to 2000 nm"),
    _edit("wavelength of radio", '"580 nm"', '"3 m"', "[camera1] band"),
    _edit("pin larger than bushing", '"33.36 mm"', '"33.60 mm"', "bushing_radius"),
    _edit("pin as large as the bushing", '"33.36 mm"', '"33.59 mm"', "bushing_radius"),
    _edit("crank too long", CRANK, 'crank = "55 cm"', "crank must be the shortest link"),
    _edit("links in mm for cm", '"44 cm"', '"44 mm"', "no crank-rocker"),
    _edit("ground too long", '"51 cm"', '"5.1 m"', "no crank-rocker"),
    _edit("unknown mechanism", '"crank-rocker"', '"planetary"', "[mechanism] kind"),
    _edit("region outside the image", "x = [4, 15]", "x = [40, 150]", "region of interest"),
    _edit("region in reverse", "x = [4, 15]", "x = [15, 4]", "roi"),
    _edit("region of one number", "x = [4, 15]", "x = [4]", "roi"),
    _edit("no load", 'load = "222.411 N"', 'load = "0 N"', "[joint] load"),
    _edit("no viscosity", 'viscosity = "0.12 Pa s"', "", "viscosity"),
    _edit("viscosity as cSt", '"0.12 Pa s"', '"120 cSt"', "viscosity"),
    # names of files
    _edit("camera without files", "camera1/*.tif", "camera3/*.tif", "there is none", "camera3"),
    _edit("cameras of the same files", "camera2/*.tif", "camera1/*.tif", "both [camera1]"),
    _edit("name climbs out", "camera1/*.tif", "../fixture/camera1/*.tif", "--allow-outside"),
    _edit("log of /etc", '"encoder.csv"', '"/etc/passwd"', "--allow-outside"),
    _edit("dark is not there", "camera1_dark.tif", "dark1.tif", "dark1.tif", "Put them there"),
    _edit("log is not there", '"encoder.csv"', '"log.csv"', "log.csv", "file in"),
    _edit(
        "dark and offset",
        "dark = ",
        'offset = "64 DN"\ndark = ',
        "camera1: give either dark",
        "not both",
    ),
    _edit(
        "neither dark nor offset", 'dark = "camera1_dark.tif"', "", "camera1: give the dark frames"
    ),
    _edit(
        "calibration is a directory",
        '"../fixture/calibration.nc"',
        '"../fixture"',
        "is a directory. Name its file",
    ),
    _edit("no calibration", 'calibration = "../fixture/calibration.nc"', "", "--calibration"),
    _edit("depth of 10", "bit_depth = 12", "bit_depth = 10", "up to 1023", "bit_depth = 12 fits"),
    _edit("bands exchanged", '"580 nm"', '"650 nm"', "look swapped"),
    _edit("bands of another fixture", '"580 nm"', '"560 nm"', "Calibrate with the filters"),
    # the fixture
    _fixture("key misspelt", "profile", "profil", "did you mean 'profile'?"),
    _fixture("profile is not there", '"profile.csv"', '"wedge.csv"', "wedge.csv", "Save"),
    _fixture("origin of one number", "[0.0, 0.0]", "[0.0]", "[fixture.origin] 1: missing"),
    _fixture("origin NaN", "[0.0, 0.0]", "[nan, 0.0]", "[fixture.origin] 0", "finite"),
    _fixture(
        "origin far outside", "[0.0, 0.0]", "[1e6, 0.0]", "points of the profile in the image"
    ),
    _fixture("direction in mm", '"0 deg"', '"0 mm"', "[fixture] direction"),
    _fixture("a run's table", "[fixture]", "[run]\nname = 'a'\n[fixture]", "run: unknown key"),
    _fixture("pitch in mm for um", '"150 um"', '"150 mm"', "pixel_pitch"),
]
