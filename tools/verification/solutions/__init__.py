"""Exact and reference solutions that the verification cases are judged by (theory.md, 18)."""
