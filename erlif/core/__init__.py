"""The shared language of the stages: errors, flags, units, products and files."""
