"""Directories, files and formats: what erlif reads and writes."""
