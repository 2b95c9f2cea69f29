// Signals that end a request.

/** A signal that aborts when either of two does. Browsers from before 2024 cannot join them: there only the time limit ends a request. */
export function joinedSignal(own: AbortSignal, limit: AbortSignal): AbortSignal {
  return "any" in AbortSignal ? AbortSignal.any([own, limit]) : limit;
}
