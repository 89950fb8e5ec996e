"""What a run shows of mistakes in its files, its log and its settings, at no cost to its film."""
