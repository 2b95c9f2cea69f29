"""The reference of the service's settings, from their declaration."""

from pydantic import SecretStr

from docs_site.cli_reference import table_cell
from service.configuration.settings import Settings

HEAD = """# Settings: reference

Each is given as an option of `rundown serve`, as `RUNDOWN_<NAME>` in the environment, or by its name in a TOML file
([operators](operators.md#settings) say which goes before which).

| setting | default | meaning |
|---|---|---|
"""


def settings_page() -> str:
    """Return the page: a row for each setting."""
    rows = []
    for name, field in Settings.model_fields.items():
        value = field.default.get_secret_value() if isinstance(field.default, SecretStr) else field.default
        shown = f"`{value}`" if value not in ("", None) else ""
        rows.append(f"| `{name}` | {shown} | {table_cell(field.description or '')} |")
    return HEAD + "\n".join(rows) + "\n"
