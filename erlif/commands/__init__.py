"""The command line, a thin door: parse, call, say where the result is."""
