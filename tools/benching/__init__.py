"""Speed of the program: cases, kernels, limits, and the page about them."""
