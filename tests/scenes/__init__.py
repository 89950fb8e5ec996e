"""Scenes with known truth, which share no code with the stages under test."""
