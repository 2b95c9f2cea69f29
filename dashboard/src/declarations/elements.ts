// Written by `python -m service.commands.page_declarations` from estimator/diagnosis/finding_kinds.py; not to be changed here.

/** Kinds of elements that alerts may concern, with the list of a machine's document that names them. */
export const ALERTING_LISTS = [
  ["coupling", "couplings"],
  ["bearing", "bearings"],
  ["seal", "seals"],
  ["pedestal", "pedestals"],
  ["disc", "discs"],
  ["shaft", "shafts"],
  ["probe", "probes"],
  ["static_load", "static_loads"],
] as const;
