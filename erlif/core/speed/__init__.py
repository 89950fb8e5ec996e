"""What is done for time and memory alone; docs/decisions/speed.md states what each part buys."""
