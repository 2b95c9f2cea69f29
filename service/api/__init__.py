"""The REST API: `application.py` joins its rooms, `openapi.py` describes it. They import all rooms of the API (`alerts`,
`cache`, `conventions`, `findings`, `machines`, `measurements`, `operation`, `trends`), `http` and `security` in front of
them, and for the application's state `advice`, `configuration`, `delivery`, `identification`, `write_path`, `reports` and
`resilience`; no room of the API imports these two files.
"""
