"""Section 6.5 of the thesis: what a document may hold beyond its model."""
