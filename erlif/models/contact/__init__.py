"""Dry contact of a pin in a bushing, and the scaling of loads between materials.

A pin in a bushing touches over an arc. Half of that arc is the half contact angle, measured at the
axis of the pin. The models differ in how they treat the arc:

- the laws of projected and of sinusoidal pressure prescribe the pressure (Strand, 2005);
- Hertz takes the arc as flat, which holds up to about 20 degrees (Johnson, 1985; Farzaneh, 2002);
- Persson (1964) solves the arc for equal materials, up to contact all round the pin;
- Winkler's bushing is a compliant liner on a rigid shaft (Colbert et al., 2009).

The impact law is that of Lankarani and Nikravesh (1994) as used by Mukras et al. (2008).
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
