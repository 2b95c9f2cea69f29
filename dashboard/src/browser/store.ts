// A value that components follow.
import { useLayoutEffect, useState } from "preact/hooks";

export class Store<T> {
  private readonly followers = new Set<() => void>();

  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  set(next: T): void {
    if (Object.is(next, this.current)) return;
    this.current = next;
    for (const follower of [...this.followers]) follower();
  }

  follow(follower: () => void): () => void {
    this.followers.add(follower);
    return () => this.followers.delete(follower);
  }
}

/**
 * What several stores hold, followed from the very moment it is drawn: an effect behind the next frame would not hear of what
 * changes until then, and what changes only once would never be shown.
 */
export function useStores<T>(stores: Store<T>[]): T[] {
  const [, redraw] = useState(0);
  const shown = stores.map((store) => store.value);
  useLayoutEffect(() => {
    const again = () => redraw((count) => count + 1);
    const leave = stores.map((store) => store.follow(again));
    if (stores.some((store, index) => !Object.is(store.value, shown[index]))) again();
    return () => leave.forEach((one) => one());
  }, stores);
  return shown;
}

export function useStore<T>(store: Store<T>): T {
  return useStores([store])[0] as T;
}
