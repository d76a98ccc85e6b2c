"""Long tests of the program: kills, hostile input, determinism. See docs/reliability.md."""
