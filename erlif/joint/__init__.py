"""The joint on a desk and in a test log: sizing, friction, endurance."""
