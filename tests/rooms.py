"""The rooms of the house from the bottom up, and behind each the rooms that it may import; longer lists go on indented.

`python -m tests.rooms_picture` draws the same in docs/developers.md and docs/rooms.md.
"""

import re

_ARROWS = """
estimator:
estimator/bearings: estimator
estimator/films: estimator
estimator/signal: estimator
estimator/machine: estimator estimator/bearings
estimator/rotor: estimator estimator/bearings estimator/machine
estimator/trends: estimator estimator/machine
estimator/modes: estimator estimator/machine estimator/rotor
estimator/phasors: estimator estimator/machine estimator/modes estimator/rotor
estimator/statics: estimator estimator/bearings estimator/films estimator/machine estimator/modes estimator/rotor
estimator/fit/problem: estimator estimator/bearings estimator/machine estimator/phasors estimator/rotor
    estimator/statics
estimator/fit/optimisation: estimator estimator/fit/problem estimator/machine estimator/phasors estimator/rotor
estimator/fit/validation: estimator estimator/bearings estimator/fit/optimisation estimator/fit/problem
    estimator/machine estimator/modes estimator/rotor estimator/statics
estimator/fit/omitted_errors: estimator estimator/fit/optimisation estimator/fit/problem estimator/fit/validation
    estimator/machine estimator/rotor
estimator/machine/checks: estimator estimator/bearings estimator/machine
estimator/fit: estimator estimator/bearings estimator/fit/omitted_errors estimator/fit/optimisation
    estimator/fit/problem estimator/fit/validation estimator/machine estimator/machine/checks
    estimator/phasors estimator/rotor estimator/statics
estimator/runs: estimator estimator/machine estimator/phasors
estimator/thesis: estimator estimator/bearings estimator/machine estimator/modes estimator/phasors estimator/rotor
estimator/simulation: estimator estimator/bearings estimator/machine estimator/phasors estimator/rotor estimator/runs
    estimator/statics estimator/trends
estimator/updated_model: estimator estimator/bearings estimator/fit estimator/fit/problem estimator/machine
    estimator/modes estimator/phasors estimator/rotor estimator/statics
estimator/balancing: estimator estimator/fit estimator/machine estimator/phasors estimator/rotor estimator/updated_model
estimator/calibration: estimator estimator/fit estimator/fit/optimisation estimator/fit/problem estimator/fit/validation
    estimator/machine estimator/phasors estimator/rotor
estimator/alignment: estimator estimator/bearings estimator/fit estimator/fit/problem estimator/fit/validation
    estimator/machine estimator/statics estimator/updated_model
estimator/diagnosis: estimator estimator/alignment estimator/fit estimator/fit/omitted_errors estimator/fit/problem
    estimator/fit/validation estimator/machine estimator/rotor estimator/statics estimator/trends estimator/updated_model
estimator/identification: estimator estimator/fit estimator/fit/optimisation estimator/fit/problem
    estimator/fit/validation estimator/machine estimator/phasors estimator/rotor estimator/updated_model
storage:
storage/tables:
storage/encoding: estimator estimator/fit/validation estimator/phasors
storage/files:
storage/database: estimator storage storage/encoding storage/files storage/tables
storage/machines: estimator estimator/machine estimator/phasors storage storage/database storage/tables
storage/measurements: estimator estimator/phasors estimator/runs storage storage/encoding storage/tables
storage/alerts: estimator storage storage/database storage/tables
storage/backup: storage storage/database storage/encoding storage/files storage/tables
storage/findings: estimator estimator/diagnosis estimator/fit estimator/fit/validation estimator/machine
    estimator/trends estimator/updated_model storage storage/database storage/encoding storage/machines
    storage/measurements storage/tables
storage/operation: estimator storage storage/alerts storage/database storage/encoding storage/findings storage/machines
    storage/tables
formats:
formats/files: estimator estimator/bearings estimator/machine estimator/machine/checks
formats/wire: estimator estimator/machine estimator/phasors storage storage/encoding
formats/measuring_systems: estimator storage
formats/recordings: estimator estimator/calibration estimator/machine estimator/phasors estimator/runs formats/files
    formats/measuring_systems formats/wire storage storage/files
service/wording: estimator/diagnosis estimator/fit estimator/machine
service/export: estimator/machine estimator/phasors formats/files storage storage/database storage/encoding
    storage/files storage/machines storage/measurements storage/tables
service/alerts: estimator storage storage/alerts storage/tables
service/resilience: formats/wire storage storage/database storage/measurements
service/secrets: storage/backup storage/files
service/configuration: estimator service/secrets storage/encoding
service/http: estimator service/configuration service/resilience service/secrets storage/database storage/operation
service/messaging: formats/wire service/configuration
service/replication: service/configuration service/resilience storage/database storage/findings storage/operation
    storage/tables
service/sources: estimator estimator/machine estimator/runs estimator/simulation formats/recordings formats/wire
rotorundown/environment:
rotorundown/plots: estimator estimator/fit estimator/fit/omitted_errors estimator/machine estimator/modes
    estimator/phasors estimator/statics estimator/updated_model rotorundown/environment
rotorundown/summaries: estimator/alignment estimator/calibration estimator/diagnosis estimator/fit
    estimator/identification estimator/machine estimator
rotorundown/ross: estimator estimator/machine estimator/machine/checks
rotorundown/model_results: estimator estimator/balancing estimator/modes estimator/rotor estimator/updated_model
    rotorundown/environment
rotorundown: estimator estimator/alignment estimator/calibration estimator/diagnosis estimator/fit
    estimator/identification estimator/machine estimator/machine/checks estimator/modes estimator/phasors
    estimator/simulation estimator/statics estimator/updated_model formats/files formats/recordings formats/wire
    rotorundown/environment rotorundown/model_results rotorundown/plots rotorundown/ross rotorundown/summaries storage
    storage/encoding
service/workers: rotorundown/environment service/configuration service/resilience
service/edge: estimator estimator/machine estimator/phasors estimator/signal formats/files formats/measuring_systems
    formats/wire service/configuration service/sources storage
service/monitoring/rules: estimator estimator/diagnosis estimator/machine service/alerts service/wording
service/balancing: estimator estimator/balancing estimator/calibration estimator/fit estimator/machine estimator/phasors
    estimator/updated_model service/monitoring/rules service/wording storage/alerts storage/machines storage/measurements
service/monitoring/assessment: estimator/alignment estimator/diagnosis estimator/fit estimator/fit/omitted_errors
    estimator/machine estimator/rotor estimator/trends estimator/updated_model service/alerts service/monitoring/rules
service/monitoring: estimator estimator/diagnosis estimator/fit estimator/machine estimator/rotor estimator/trends
    service/alerts service/configuration service/monitoring/assessment service/monitoring/rules service/replication
    service/resilience service/workers storage storage/alerts storage/database storage/findings storage/machines
    storage/measurements storage/tables
service/advice: estimator estimator/diagnosis formats/files service/alerts service/monitoring/rules service/wording
    storage storage/alerts storage/tables
service/delivery: estimator service/advice service/alerts service/configuration service/monitoring/rules
    service/replication service/resilience service/secrets service/wording storage storage/alerts storage/backup
    storage/database storage/encoding storage/machines storage/operation storage/tables
service/runs: estimator estimator/machine estimator/phasors estimator/runs service/replication service/resilience storage
    storage/database storage/encoding storage/findings storage/machines storage/measurements storage/tables
service/security: estimator service/configuration service/http service/resilience service/wording storage
    storage/database storage/encoding storage/operation storage/tables
service/opcua: estimator estimator/machine estimator/rotor estimator/updated_model rotorundown/environment
    service/advice service/alerts service/configuration service/resilience service/runs service/security storage
    storage/alerts storage/database storage/findings storage/machines storage/operation storage/tables
service/identification: estimator estimator/balancing estimator/calibration estimator/diagnosis estimator/fit
    estimator/fit/omitted_errors estimator/fit/validation estimator/identification estimator/machine estimator/modes
    estimator/phasors estimator/runs estimator/updated_model rotorundown/environment service/balancing
    service/configuration service/monitoring service/replication service/resilience service/workers storage
    storage/database storage/encoding storage/findings storage/machines storage/measurements storage/tables
service/reports: estimator estimator/alignment estimator/balancing estimator/diagnosis estimator/machine
    estimator/phasors estimator/statics estimator/updated_model service/advice service/alerts service/balancing
    service/configuration service/delivery service/identification service/monitoring service/replication
    service/resilience service/wording service/workers storage storage/alerts storage/database storage/findings
    storage/machines storage/measurements storage/tables
service/write_path: estimator estimator/machine formats/wire service/replication service/resilience service/runs
    storage/database storage/encoding storage/machines storage/measurements storage/tables
service/mqtt: estimator/machine formats/wire service/advice service/alerts service/configuration service/write_path
    service/replication service/resilience storage storage/alerts storage/database storage/findings storage/machines
    storage/tables
service/maintenance: service/configuration service/replication service/resilience service/runs storage storage/backup
    storage/database storage/machines storage/measurements storage/operation
service/api/conventions: estimator estimator/machine formats/files service/http service/identification service/secrets
    service/security service/wording storage storage/findings
service/recovery: formats/wire service/write_path service/replication service/resilience storage/encoding
service/api/cache: estimator estimator/machine estimator/machine/checks service/api/conventions service/http
    service/workers storage/database
service/api/measurements: estimator estimator/machine estimator/phasors estimator/trends formats/wire
    service/api/conventions service/http service/identification service/runs service/write_path service/security
    storage storage/encoding storage/machines storage/measurements storage/tables
service/api/operation: formats/wire rotorundown/environment service/api/conventions service/configuration service/http
    service/replication service/security storage storage/alerts storage/database storage/findings storage/measurements
    storage/operation storage/tables
service/ingest: formats/wire service/write_path service/recovery service/replication service/resilience storage
    storage/database storage/machines storage/measurements
service/api/findings: estimator estimator/alignment estimator/balancing estimator/calibration estimator/diagnosis
    estimator/fit estimator/machine estimator/modes estimator/phasors estimator/rotor estimator/trends
    estimator/updated_model service/advice service/alerts service/api/cache service/api/conventions service/http
    service/identification service/monitoring service/monitoring/assessment service/monitoring/rules service/security
    service/wording storage storage/alerts storage/findings storage/machines storage/tables
service/api/machines: estimator estimator/balancing estimator/calibration estimator/machine estimator/machine/checks
    estimator/phasors estimator/runs estimator/statics service/alerts service/api/cache service/api/conventions
    service/balancing service/http service/identification service/monitoring service/monitoring/rules service/reports
    service/runs service/security service/wording storage storage/database storage/encoding storage/findings
    storage/machines storage/measurements storage/tables
service/api/trends: estimator estimator/trends estimator/updated_model service/api/cache service/api/conventions
    service/export service/monitoring service/security storage storage/database storage/findings storage/machines
    storage/tables
service/api/alerts: estimator service/advice service/alerts service/api/cache service/api/conventions
    service/api/findings service/delivery service/monitoring/rules service/reports service/resilience service/secrets
    service/security service/wording storage storage/alerts storage/database storage/machines storage/tables
service/api: rotorundown/environment service/advice service/api/alerts service/api/cache service/api/conventions
    service/api/findings service/api/machines service/api/measurements service/api/operation service/api/trends
    service/configuration service/delivery service/http service/identification service/write_path service/reports
    service/resilience service/security storage/database storage/tables
service/doctor: formats/wire service/api service/configuration service/delivery service/maintenance service/messaging
    service/mqtt service/security storage/alerts storage/backup storage/database storage/files storage/operation
service/commands/results: estimator estimator/alignment estimator/balancing estimator/calibration estimator/fit
    estimator/identification estimator/machine estimator/modes estimator/phasors estimator/statics estimator/thesis
    estimator/updated_model rotorundown rotorundown/summaries
service/commands: estimator estimator/balancing estimator/bearings estimator/calibration estimator/diagnosis
    estimator/fit estimator/fit/omitted_errors estimator/identification estimator/machine estimator/machine/checks
    estimator/phasors estimator/simulation estimator/thesis estimator/updated_model formats/files
    formats/recordings formats/wire rotorundown rotorundown/environment rotorundown/summaries service/advice service/api
    service/api/operation service/balancing service/commands/results service/configuration service/delivery
    service/doctor service/edge service/export service/http service/identification service/ingest service/maintenance
    service/messaging service/monitoring/rules service/mqtt service/opcua service/replication service/reports
    service/resilience service/runs service/secrets service/security service/sources service/wording service/workers
    service/write_path storage storage/backup storage/database storage/encoding storage/machines storage/operation
    storage/tables
service: estimator/machine rotorundown service/alerts service/api/alerts service/api/findings service/api/machines
    service/api/measurements service/api/trends service/commands service/http
"""

ROOMS: dict[str, tuple[str, ...]] = {
    room: tuple(others.split()) for room, others in re.findall(r"^(\S+):(.*(?:\n    .*)*)", _ARROWS, re.MULTILINE)
}
