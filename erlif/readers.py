"""`erlif.readers` is the public name of `erlif.io.readers`."""

import sys

from erlif.io import readers

sys.modules[__name__] = readers
