"""One page in the browser from folders of frames to a film."""

from erlif.show.start.page import serve_start, start_page

__all__ = ["serve_start", "start_page"]
