from .encoder_log import read_encoder_log
from .frames import (
    FramePairs,
    PairCounts,
    format_notes,
    read_frames,
    read_pair,
    skipped_notes,
)
from .hashes import (
    InputChangedError,
    hash_files_beside_frames,
    hash_inputs,
    refuse_changed,
    sign_inputs,
    stamp_inputs,
)
from .images import Page, depth_warning, natural_key, read_reference_pages
from .recording import Fixture, FoundStart, Run, open_fixture, open_run
from .run_table import RunEntry, read_run_table
from .selection import Selection, select_counts

__all__ = [
    "Fixture",
    "FoundStart",
    "FramePairs",
    "InputChangedError",
    "Page",
    "PairCounts",
    "Run",
    "RunEntry",
    "Selection",
    "depth_warning",
    "format_notes",
    "hash_files_beside_frames",
    "hash_inputs",
    "natural_key",
    "open_fixture",
    "open_run",
    "read_encoder_log",
    "read_frames",
    "read_pair",
    "read_reference_pages",
    "read_run_table",
    "refuse_changed",
    "select_counts",
    "sign_inputs",
    "skipped_notes",
    "stamp_inputs",
]
