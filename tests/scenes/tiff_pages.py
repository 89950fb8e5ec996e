"""Images as pages of a TIFF, and recorded counts changed on purpose."""

import tifffile


def rewrite(path, change):
    """Change the counts of every page of a TIFF."""
    with tifffile.TiffFile(path) as file:
        pages = [change(page.asarray()) for page in file.pages]
    write_pages(path, pages)


def write_pages(path, pages):
    """Write images as the pages of one TIFF."""
    with tifffile.TiffWriter(path) as file:
        for page in pages:
            file.write(page, contiguous=False, metadata=None, photometric="minisblack")
