"""The errors erlif raises on purpose. Each message says what was expected, what came and what to do."""


class ErlifError(Exception):
    """Base of every error that the input, not erlif, has caused. The commands answer it with exit status 2."""


class ConfigError(ErlifError):
    """A settings file (run.toml, fixture.toml) that cannot be used as it stands."""


class FrameError(ErlifError):
    """Frames that are missing, damaged, of another size, or that do not fit their settings."""


class EncoderError(ErlifError):
    """An encoder log that does not belong to the frames or to the mechanism."""


class RegistrationError(ErlifError):
    """Two cameras whose images could not be laid over each other."""


class CalibrationError(ErlifError):
    """A calibration that could not be made, or that does not belong to the run."""


class OutputError(ErlifError):
    """An output that exists already or could not be written."""


class ModelError(ErlifError, ValueError):
    """An argument outside the range in which a model of the joint means something."""
