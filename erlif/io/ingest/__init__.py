"""A directory to counts: recordings, image formats, pairing of the cameras, the encoder log."""

from erlif.io.ingest.encoder_log import read_encoder_log
from erlif.io.ingest.frames import (
    FramePairs,
    PairCounts,
    format_notes,
    read_frames,
    read_pair,
    skipped_notes,
)
from erlif.io.ingest.hashes import (
    InputChangedError,
    hash_files_beside_frames,
    hash_inputs,
    refuse_changed,
    sign_inputs,
    stamp_inputs,
)
from erlif.io.ingest.images import Page, depth_warning, natural_key
from erlif.io.ingest.recording import Fixture, FoundStart, Run, open_fixture, open_run
from erlif.io.ingest.reference_pages import read_reference_pages
from erlif.io.ingest.run_table import RunEntry, read_run_table
from erlif.io.ingest.selection import Selection, select_counts

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
