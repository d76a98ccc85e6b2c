"""The job with ghost penalty beside that without."""

from verification.siblings import ratio_to_sibling

__all__ = ["ratio_to_sibling"]
