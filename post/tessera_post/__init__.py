"""Pictures, reports and conversions of Tessera's results; `tessera-post --help` lists them."""

__version__ = "0.1.0"
