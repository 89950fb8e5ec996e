"""What belongs to a recording as a whole: cameras, pulses, clock, registration."""
