"""Properties of a recording as a whole: cameras, pulses, clock, registration."""
