"""How the documentation is built: ``python -m sphinx -W --keep-going docs build/docs``.

Nothing is fetched while building or reading: formulas become MathML, figures come from the sample
run in the repository, and there are no links into other projects' inventories.
"""

import inspect
import os
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import get_origin

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[1]

sys.path.insert(0, str(ROOT))
sys.path.insert(0, str(ROOT / "docs" / "gallery"))
os.environ["PYTHONPATH"] = os.pathsep.join(
    (str(ROOT), str(ROOT / "docs" / "gallery"), os.environ.get("PYTHONPATH", ""))
)  # for the kernel of the tutorial

from erlif.core.version import __version__  # noqa: E402

project = "erlif"
author = "The erlif developers"
copyright = "The erlif developers"
release = version = __version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "gallery",
    "auto_gallery/*.ipynb",
    "auto_gallery/*.py*",
    "_build",
    "**/sg_execution_times*",
    "sg_execution_times*",
    "coverage.md",  # for who works on erlif: read in the repository
    "sources.md",
]
root_doc = "index"
default_role = "py:obj"
toc_object_entries_show_parents = "hide"
smartquotes_action = "qe"  # an option --overwrite keeps its two dashes
suppress_warnings = ["config.cache"]  # the gallery's configuration holds a class

# MyST and the tutorial
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_merge_streams = True

# API reference
autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # types stand in the signature's place in the Parameters section
autodoc_default_options = {"members": True, "exclude-members": "model_config"}
numpydoc_show_class_members = False
python_maximum_signature_line_length = 88

# Gallery


def scrape_drawn(block: tuple, variables: dict, gallery_conf: dict) -> str:
    """Save the figures of a block; one with empty axes ends the build.

    The gallery closes all figures after each block, so that what a later block draws is lost.
    """
    from matplotlib import pyplot
    from sphinx_gallery.scrapers import matplotlib_scraper

    for number in pyplot.get_fignums():
        bare = [ax for ax in pyplot.figure(number).axes if ax.axison and not ax.has_data()]
        if bare:
            raise RuntimeError(
                f"{variables['src_file']}: a figure has {len(bare)} axes without data. Make the "
                "figure in the block that draws it."
            )
    return matplotlib_scraper(block, variables, gallery_conf)


sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"/plot_",
    "ignore_pattern": r"sample\.py",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 10,
    "abort_on_example_error": True,
    "run_stale_examples": True,  # figures follow erlif, not only their scripts
    "image_srcset": ["2x"],
    "image_scrapers": (scrape_drawn,),
}

# HTML
html_theme = "pydata_sphinx_theme"
html_title = "erlif"
html_static_path = ["_static"]
html_css_files = ["erlif.css"]
html_show_sourcelink = False
html_copy_source = False
html_math_renderer = "mathml"
html_search_scorer = str(ROOT / "docs" / "scorer.js")
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 5,
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": {"**": ["page-toc"], "index": []},
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
NAVIGATION = {
    "index": ("why", "use", "data", "theory/index", "develop"),
    "why": ("challenge",),
    "use": (
        "From frames to film <start>",
        "Your data <your_data>",
        "Tutorial <tutorial>",
        "Look at a film <viewer>",
        "In a notebook <notebook>",
        "Planning <planning>",
        "Design of a joint <design>",
        "Prediction <prediction>",
        "Commands <commands>",
    ),
    "your_data": (
        "Watch a run <watch>",
        "Other tribometers <tribometers>",
        "limits",
        "The virtual rig <simulator>",
    ),
    "viewer": ("figures", "compare"),
    "notebook": ("auto_gallery/index",),
    "design": ("linkage", "endurance", "friction"),
    "commands": ("shell_completion",),
    "data": (
        "formats",
        "logs",
        "Settings <settings>",
        "film.nc <film_nc>",
        "Other files <other_files>",
        "export",
        "Glossary <glossary>",
    ),
    "export": ("matlab",),
    "theory/index": (
        "fluorescence",
        "Registration </registration>",
        "Uncertainty </uncertainty>",
        "film",
        "reynolds",
        "edges",
        "endurance",
        "Bibliography </bibliography>",
    ),
    "theory/film": ("Film and speed </speed>", "Which theory? <which>", "slider_crank"),
    "theory/reynolds": ("position", "fit", "pressure", "friction"),
    "develop": (
        "API <api/index>",
        "architecture",
        "decisions/index",
        "performance",
        "container",
        "stability",
        "Release <release>",
        "cite",
    ),
}
"""Pages below each page, in the order of the bar and the side bars."""

html_sidebars = {"index": []}

STAGES = (
    "io.readers",
    "io.ingest",
    "correction",
    "registration",
    "ratio",
    "calibration",
    "thickness",
    "planning",
    "kinematics",
    "trend",
    "prediction",
    "pipeline",
    "review.check",
    "io.conversion",
    "review.comparison",
    "io.files",
    "show.plots",
    "show.report",
    "show.notebook",
    "show.view",
    "io.settings",
    "rig",
    "joint.sizing",
    "joint.friction",
    "joint.endurance",
    "joint.plots",
    "joint.report",
    "joint.settings",
    "joint.rig",
)
"""Stages whose exported names are documented, in the order of the pipeline."""

MODELS = (
    "models.contact",
    "models.film",
    "models.fluorescence",
    "models.mechanism",
    "models.oil",
    "models.reynolds",
    "models.shear",
    "joint.models.bearing",
    "joint.models.edges",
    "joint.models.friction",
    "joint.models.reaction",
    "joint.models.slider_dynamics",
    "joint.models.slider_wear",
    "joint.models.wear",
)


def exported(name: str) -> list[str]:
    """Functions and classes of a module's ``__all__``, or all public ones where there is none."""
    module = import_module(name)
    names = getattr(module, "__all__", None)
    if names is None:
        names = sorted(
            each
            for each, thing in vars(module).items()
            if not each.startswith("_") and getattr(thing, "__module__", None) == name
        )
    return [each for each in names if is_documented(getattr(module, each))]


def is_documented(thing: object) -> bool:
    """Whether a page lists it: constants and the unit types of the settings have no page."""
    return inspect.isroutine(thing) or (inspect.isclass(thing) and get_origin(thing) is None)


def write_api_pages(app: Sphinx) -> None:
    """Write one page for each stage from its ``__all__``, so that no exported name is missing."""
    folder = Path(app.srcdir) / "api"
    for name in (*STAGES, *MODELS):
        full = f"erlif.{name}"
        names = "\n".join(f"   {each}" for each in exported(full))
        text = (
            f"{full}\n{'=' * len(full)}\n\n.. currentmodule:: {full}\n\n"
            f".. autosummary::\n   :nosignatures:\n\n{names}\n\n"
            f".. automodule:: {full}\n   :members: {', '.join(exported(full))}\n"
        )
        page = folder / f"{name}.rst"
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")


def escape_bars(
    app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]
) -> None:
    """Keep |speed| in a docstring from being read as a reStructuredText substitution."""
    doctest = False
    for n, line in enumerate(lines):
        doctest = bool(line.strip()) and (doctest or line.lstrip().startswith(">>>"))
        if not doctest and "``" not in line:
            lines[n] = re.sub(r"(?<!\\)\|", r"\|", line)


def add_navigation(app: Sphinx, docname: str, source: list[str]) -> None:
    """Append the pages below a page, which its side bar lists."""
    if pages := NAVIGATION.get(docname):
        entries = "\n".join(pages)
        source[0] += f"\n\n```{{toctree}}\n:hidden:\n\n{entries}\n```\n"


def inline_math(self, node: nodes.math) -> None:
    """Write a formula in a line as MathML, which browsers draw without a script."""
    self.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def display_math(self, node: nodes.math_block) -> None:
    """Write a displayed formula as MathML in a block that scrolls where it is too wide."""
    self.body.append(f'<div class="math">{tex2mathml(node.astext(), as_block=True)}</div>\n')
    raise nodes.SkipNode


def refuse_equal_pictures(app: Sphinx, error: Exception | None) -> None:
    """End the build where two pictures of the site are the same."""
    found: dict[bytes, str] = {}
    for path in sorted(Path(app.outdir, "_images").glob("*.png")) if error is None else ():
        other = found.setdefault(path.read_bytes(), path.name)
        if other != path.name:
            raise RuntimeError(f"{other} and {path.name} are the same picture.")


def setup(app: Sphinx) -> None:
    """Register the MathML renderer and the pages of the API reference."""
    app.connect("build-finished", refuse_equal_pictures)
    app.add_html_math_renderer("mathml", (inline_math, None), (display_math, None))
    app.connect("builder-inited", write_api_pages, priority=100)
    app.connect("source-read", add_navigation)
    app.connect("autodoc-process-docstring", escape_bars)
