from erlif.io.settings import *
