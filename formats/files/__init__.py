"""Documents and tables in files: YAML, JSON and CSV, with errors that a person can act on. They import nothing else of this
package; they give machine documents to commands, the library and recordings.
"""
