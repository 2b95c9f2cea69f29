// The legend of the marks on the drawing of the train.

export function TrainLegend() {
  return (
    <p class="legend muted">
      <span class="normal">■</span> at baseline <span class="unknown">▢</span> unknown <span class="changed">●</span> changed <span class="alert">▲</span> alert{" "}
      <span class="danger">◆</span> danger
    </p>
  );
}
