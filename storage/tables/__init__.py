"""The tables of the store. It imports no other room; every repository reads and writes their rows. Times are nanoseconds since
1970 in UTC; physical values are SI.
"""

from storage.tables.alerting import AlertEventRow, AlertRow, DeliveryRow, SubscriptionPlantRow, SubscriptionRow, SuppressionRow
from storage.tables.base import Base
from storage.tables.findings import DerivedRow, DiagnosisRow, EstimateRow, IdentificationRow, JobRow
from storage.tables.machines import BaselineRow, CalibrationRow, LimitsRow, MachineRow, RevisionRow, SlowRollRow, TimelineRow
from storage.tables.measurements import (
    CollectorRow,
    MachineStateRow,
    QuarantineCountRow,
    QuarantineRow,
    RunRow,
    SampleBlockRow,
    SourceRow,
)
from storage.tables.operation import (
    ApiKeyRow,
    AuditHeadRow,
    AuditRow,
    BrowserSessionRow,
    ChangeCountRow,
    IdempotencyKeyRow,
    LeaseRow,
    LoginRow,
    ReplicaRow,
    RetentionRow,
)

__all__ = [
    "AlertEventRow",
    "AlertRow",
    "ApiKeyRow",
    "AuditHeadRow",
    "AuditRow",
    "Base",
    "BaselineRow",
    "BrowserSessionRow",
    "CalibrationRow",
    "ChangeCountRow",
    "CollectorRow",
    "DeliveryRow",
    "DerivedRow",
    "DiagnosisRow",
    "EstimateRow",
    "IdempotencyKeyRow",
    "IdentificationRow",
    "JobRow",
    "LeaseRow",
    "LimitsRow",
    "LoginRow",
    "MachineRow",
    "MachineStateRow",
    "QuarantineCountRow",
    "QuarantineRow",
    "ReplicaRow",
    "RetentionRow",
    "RevisionRow",
    "RunRow",
    "SampleBlockRow",
    "SlowRollRow",
    "SourceRow",
    "SubscriptionPlantRow",
    "SubscriptionRow",
    "SuppressionRow",
    "TimelineRow",
]
