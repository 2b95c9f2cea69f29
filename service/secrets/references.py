"""Permitted references to secrets: files of one folder, and variables with one prefix."""

VARIABLE_PREFIX = "RUNDOWN_WEBHOOK_SECRET_"
VARIABLE = rf"^{VARIABLE_PREFIX}[A-Z0-9_]{{1,64}}$"
FILE_NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$"
