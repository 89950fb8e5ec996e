"""Wear after Archard (1953), worn bushings, and the heat and pv of a sliding joint.

The wear laws are those of Farzaneh (2002) and Strand (2005), who also gives the heat. The worn
bushing is that of Colbert et al. (2009), appendix A. The wear that changes its own forces is that
of Mukras et al. (2008). Arguments that are off by orders of magnitude raise
`erlif.core.errors.UnitWarning`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
