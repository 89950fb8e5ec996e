from erlif.io.ingest import *
