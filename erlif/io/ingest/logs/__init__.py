"""Files of data loggers to one row for each frame: tables, columns, units, times."""
