"""The REST API: `application.py` joins its rooms, `openapi.py` describes it. Nothing below imports these two."""
