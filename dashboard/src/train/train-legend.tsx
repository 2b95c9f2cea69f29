// The legend of the marks on the drawing of the train.
import { t, term } from "../messages/messages";

export function TrainLegend() {
  return (
    <p class="legend muted">
      <span class="normal">■</span> {t("atBaseline")} <span class="unknown">▢</span> {term("unknown")} <span class="changed">●</span> {t("changed")} <span class="alert">▲</span> {term("alert")}{" "}
      <span class="danger">◆</span> {term("danger")}
    </p>
  );
}
