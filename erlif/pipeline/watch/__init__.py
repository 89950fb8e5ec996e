"""The film while the machine turns: pairs are measured as they arrive."""
