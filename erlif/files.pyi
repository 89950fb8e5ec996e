from erlif.io.files import *
