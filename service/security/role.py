"""Roles of principals, and their names in keys, tokens and answers."""

from enum import IntEnum

from estimator.close_matches import did_you_mean


class Role(IntEnum):
    """Roles in ascending order; each includes the rights of those before it. A source only sends samples."""

    SOURCE = 0
    VIEWER = 1
    ANALYST = 2
    OPERATOR = 3
    ADMIN = 4

    @property
    def label(self) -> str:
        """Return the role's name as in keys, tokens and answers."""
        return self.name.lower()

    @classmethod
    def of(cls, label: str) -> "Role":
        """Return the role of a label. Raises ValueError."""
        try:
            return cls[label.upper()]
        except KeyError:
            known = [role.label for role in cls]
            raise ValueError(f"'{label}' is no role; there are {', '.join(known)}{did_you_mean(label, known)}") from None
