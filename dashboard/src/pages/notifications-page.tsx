// Notifications of alerts: the subscriptions, and how one is added.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Panel, Truncated } from "../components/panel";
import { useResource } from "../data/resource";
import { SubscriptionDialog } from "../dialogs/subscription-dialog";
import { rich, t } from "../messages/messages";
import { SubscriptionPanel } from "../panels/subscription-panel";
import type { NewSubscription, Subscription } from "../schemas/subscriptions";

const LIMIT = 200;

export function NotificationsPage() {
  const [adds, setAdds] = useState(false);
  const [added, setAdded] = useState<NewSubscription | null>(null);
  const result = useResource<Subscription[]>(`/subscriptions?limit=${LIMIT}`, 15_000);
  return (
    <>
      <h1>{t("notifications")}</h1>
      <Panel
        title={t("subscriptions")}
        aside={
          <button type="button" onClick={() => setAdds(true)}>
            {t("addDots")}
          </button>
        }
      >
        {added?.secret && (
          <p class="secret" role="status">
            {rich("signingSecret", { name: added.name, secret: <code>{added.secret}</code> })}
          </p>
        )}
        <Loaded result={result} lines={6}>
          {(all) =>
            all.length === 0 ? (
              <Empty>{t("noSubscriptionsYetNobodyIs")}</Empty>
            ) : (
              <>
                {all.map((one) => (
                  <SubscriptionPanel key={one.id} subscription={one} />
                ))}
                <Truncated shown={all.length} limit={LIMIT} which="oldest" />
              </>
            )
          }
        </Loaded>
      </Panel>
      {adds && <SubscriptionDialog onAdded={setAdded} onClose={() => setAdds(false)} />}
    </>
  );
}
