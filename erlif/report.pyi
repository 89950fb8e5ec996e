from erlif.show.report import *
