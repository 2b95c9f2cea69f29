// The state of the connection to the service: a word in the bar, and a banner when something is wrong.
import { useStore } from "../browser/store";
import { connection } from "../data/connection";
import { clock } from "../format/times";

const LABELS = { connecting: "○ connecting", live: "● live", degraded: "✕ no data", lost: "✕ no connection" };

export function ConnectionState() {
  const { state } = useStore(connection);
  return (
    <span class={`connection-state ${state}`} role="status">
      {LABELS[state]}
    </span>
  );
}

export function ConnectionBanner() {
  const { state, since, reason } = useStore(connection);
  if (state === "degraded") {
    return (
      <div class="banner" role="alert">
        <strong>The service answers, but cannot read its data since {clock(since)}:</strong> {reason} The data shown are older. The
        page retries every few seconds and recovers by itself.
      </div>
    );
  }
  if (state !== "lost") return null;
  return (
    <div class="banner" role="alert">
      <strong>The service does not answer since {clock(since)}.</strong> The data shown are older. The page retries every second
      and recovers by itself.
    </div>
  );
}
