"""Summaries of what the library and the commands find: text for a terminal or a notebook, and columns of data frames. They
import `estimator` alone; results and commands print them.
"""
