"""A directory to counts: recordings, image formats, pairing of the cameras, the encoder log."""

from erlif.ingest.encoder_log import read_encoder_log
from erlif.ingest.hashes import hash_inputs
from erlif.ingest.images import Page, depth_warning, natural_key
from erlif.ingest.recording import Recording, open_fixture, open_run, read_frames, skipped_notes
from erlif.ingest.references import find_reference_pages, read_reference

__all__ = [
    "Page",
    "Recording",
    "depth_warning",
    "find_reference_pages",
    "hash_inputs",
    "natural_key",
    "open_fixture",
    "open_run",
    "read_encoder_log",
    "read_frames",
    "read_reference",
    "skipped_notes",
]
