from erlif.show.plots import *
