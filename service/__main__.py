"""`python -m service` is the command `rundown`."""

from service.cli import main

main()
