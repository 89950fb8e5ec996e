"""A catalogue of named damages, and the bench on which they are tried."""
