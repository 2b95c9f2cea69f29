// The tabs of a machine's page, in the order of the keys 1 to 8.
import { t } from "../messages/messages";

export const TABS = [
  { id: "overview", name: t("overview") },
  { id: "vibration", name: t("vibration") },
  { id: "trends", name: t("trends") },
  { id: "response", name: t("bodeAndPolar") },
  { id: "shapes", name: t("orbitsAndModes") },
  { id: "model", name: t("model") },
  { id: "balancing", name: t("balancing") },
  { id: "identified", name: t("parameters") },
  { id: "settings", name: t("limitsAndSuppressions") },
] as const;
