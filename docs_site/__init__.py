"""Builds the documentation as a site: the pages of `docs`, references made from the code, the notebooks with figures.

python -m docs_site [FOLDER] [--short]
"""
