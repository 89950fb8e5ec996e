from erlif.io.conversion import *
