// Notifications of alerts: the subscriptions, and how one is added.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Panel, Truncated } from "../components/panel";
import { useResource } from "../data/resource";
import { SubscriptionDialog } from "../dialogs/subscription-dialog";
import { SubscriptionPanel } from "../panels/subscription-panel";
import type { NewSubscription, Subscription } from "../schemas/subscriptions";

const LIMIT = 200;

export function NotificationsPage() {
  const [adds, setAdds] = useState(false);
  const [added, setAdded] = useState<NewSubscription | null>(null);
  const result = useResource<Subscription[]>(`/subscriptions?limit=${LIMIT}`, 15_000);
  return (
    <>
      <h1>Notifications</h1>
      <Panel
        title="Subscriptions"
        aside={
          <button type="button" onClick={() => setAdds(true)}>
            Add …
          </button>
        }
      >
        {added?.secret && (
          <p class="secret" role="status">
            The secret that signs messages to {added.name}, shown only once: <code>{added.secret}</code>
          </p>
        )}
        <Loaded result={result} lines={6}>
          {(all) =>
            all.length === 0 ? (
              <Empty>No subscriptions yet: nobody is notified of alerts.</Empty>
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
