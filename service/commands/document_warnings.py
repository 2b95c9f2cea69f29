"""Prints what is probably a mistake in a machine document that is taken."""

from estimator.machine.checks.document_warnings import document_warnings
from estimator.machine.document import Machine
from service.commands.terminal import print_line


def print_warnings(machine: Machine) -> None:
    """Print the warnings of a document on the standard error output, one a line."""
    for one in document_warnings(machine):
        print_line(f"warning: {one}", err=True)
