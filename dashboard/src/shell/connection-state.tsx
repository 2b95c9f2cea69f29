// The state of the connection to the service: a word in the bar, and a banner when something is wrong.
import { useStore } from "../browser/store";
import { connection } from "../data/connection";
import { clock } from "../format/times";
import { rich, t } from "../messages/messages";

const LABELS = { connecting: t("connectionConnecting"), live: t("connectionLive"), degraded: t("connectionNoData"), lost: t("connectionLost") };

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
        {rich("degradedBanner", { what: <strong>{t("theServiceAnswersButCannot", { since: clock(since) })}</strong>, reason })}
      </div>
    );
  }
  if (state !== "lost") return null;
  return (
    <div class="banner" role="alert">
      {rich("lostBanner", { what: <strong>{t("serviceSilentSince", { since: clock(since) })}</strong> })}
    </div>
  );
}
