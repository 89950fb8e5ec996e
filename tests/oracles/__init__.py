"""Independent solutions of problems that erlif solves by formulas; no code is shared with it."""
