"""Several people at one review: who is here, where each points, and who changes what."""
