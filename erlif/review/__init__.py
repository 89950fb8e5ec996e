"""A run seen from outside: audit before, budget after, comparison between runs."""
