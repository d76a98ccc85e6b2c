"""Runs the verification cases and judges their results: `tools/verify`."""
