// An observable value, and hooks with which components subscribe to it.
import { useLayoutEffect, useState } from "preact/hooks";

export class Store<T> {
  private readonly subscribers = new Set<() => void>();

  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  set(next: T): void {
    if (Object.is(next, this.current)) return;
    this.current = next;
    for (const subscriber of [...this.subscribers]) subscriber();
  }

  subscribe(subscriber: () => void): () => void {
    this.subscribers.add(subscriber);
    return () => this.subscribers.delete(subscriber);
  }
}

/**
 * The values of several stores. A layout effect subscribes before the first frame: an effect after it would miss changes until
 * then, and a value that changes only once would never be shown.
 */
export function useStores<T>(stores: Store<T>[]): T[] {
  const [, redraw] = useState(0);
  const shown = stores.map((store) => store.value);
  useLayoutEffect(() => {
    const update = () => redraw((count) => count + 1);
    const unsubscribe = stores.map((store) => store.subscribe(update));
    if (stores.some((store, index) => !Object.is(store.value, shown[index]))) update();
    return () => unsubscribe.forEach((one) => one());
  }, stores);
  return shown;
}

export function useStore<T>(store: Store<T>): T {
  return useStores([store])[0] as T;
}
