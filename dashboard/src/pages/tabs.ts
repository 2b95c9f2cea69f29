// The tabs of a machine's page, in the order of the keys 1 to 8.

export const TABS = [
  { id: "overview", name: "Overview" },
  { id: "vibration", name: "Vibration" },
  { id: "trends", name: "Trends" },
  { id: "response", name: "Bode and polar" },
  { id: "shapes", name: "Orbits and modes" },
  { id: "model", name: "Model" },
  { id: "balancing", name: "Balancing" },
  { id: "identified", name: "Parameters" },
  { id: "settings", name: "Limits and suppressions" },
] as const;
