"""The joint and its film: motion, prediction, pressure, light that is not film."""
