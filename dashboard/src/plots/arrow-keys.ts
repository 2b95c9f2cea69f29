// Arrow keys that move a read-out.

const STEPS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** How far an arrow key moves to the right and down, ten times as far with Shift; null for other keys. */
export function arrowStep(event: KeyboardEvent): [number, number] | null {
  const step = STEPS[event.key];
  if (!step || event.ctrlKey || event.metaKey || event.altKey) return null;
  const size = event.shiftKey ? 10 : 1;
  return [size * step[0], size * step[1]];
}

/** An index kept within a list of so many. */
export function clampIndex(index: number, count: number): number {
  return Math.min(count - 1, Math.max(0, index));
}
