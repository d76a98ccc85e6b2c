"""The jobs with METIS patches beside those with patches of quadratic elements."""

from verification.siblings import ratio_to_sibling

__all__ = ["ratio_to_sibling"]
