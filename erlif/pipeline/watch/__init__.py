"""The film while the machine turns: pairs measured as they arrive, before the recording is whole."""
