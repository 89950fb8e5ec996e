"""Hypothesis without a deadline: the duration of an example depends on the load of the machine."""

from hypothesis import settings

settings.register_profile("models", deadline=None)
settings.load_profile("models")
