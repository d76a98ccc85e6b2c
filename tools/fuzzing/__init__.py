"""Hostile input by the million: see docs/reliability.md and tools/fuzz."""
