"""`erlif.plots` is the public name of `erlif.show.plots`."""

import sys

from erlif.show import plots

sys.modules[__name__] = plots
