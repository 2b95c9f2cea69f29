"""The REST API. `application.py` joins its rooms and `openapi.py` describes it; nothing below imports these two."""
