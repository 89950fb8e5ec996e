"""Optimisations of time and memory; docs/decisions/speed.md states the effect of each."""
