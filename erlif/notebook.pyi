from erlif.show.notebook import *
