from erlif.io.readers import *
