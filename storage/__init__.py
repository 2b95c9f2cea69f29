"""What Rundown remembers: tables, migrations and repositories. SQLite embedded by default, PostgreSQL by URL."""
