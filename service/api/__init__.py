"""The REST API: `application.py` puts its rooms together, `openapi.py` describes it. Nothing below imports these two."""
