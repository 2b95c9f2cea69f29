// Arrow keys, for read-outs that they move.

const STEPS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** How far to the right and down an arrow key moves, with Shift ten times as far; null: another key. */
export function arrow(event: KeyboardEvent): [number, number] | null {
  const step = STEPS[event.key];
  if (!step || event.ctrlKey || event.metaKey || event.altKey) return null;
  const far = event.shiftKey ? 10 : 1;
  return [far * step[0], far * step[1]];
}

/** Among so many places. */
export function within(place: number, count: number): number {
  return Math.min(count - 1, Math.max(0, place));
}
