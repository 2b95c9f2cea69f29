// One subscription to alerts: enabled, disabled and tested; the log of its deliveries.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Truncated } from "../components/panel";
import { ReportSelect } from "../components/report-select";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import { CHANNELS } from "../declarations/channels";
import { ApiError, getWithEtag, post, put } from "../data/http-client";
import { refetch, useResource } from "../data/resource";
import { words } from "../format/names";
import { rich, stored, t, term } from "../messages/messages";
import type { Delivery, ReportInterval, Subscription, TestOutcome } from "../schemas/subscriptions";

const LOG_LIMIT = 20;

export function SubscriptionPanel({ subscription }: { subscription: Subscription }) {
  const [open, setOpen] = useState(false);
  const { name, kind, target, state, reason, created_at: added } = subscription;
  return (
    <section class="subscription" data-subscription={subscription.id}>
      <h3>
        {name} <span class="muted">{term(kind)}</span> {target}
      </h3>
      <p>
        {rich("addedAt", { state: state === "active" ? t("active") : t("disabled", { reason: reason ? stored(reason) : t("noReasonIsKnown") }), time: <Time at={added} /> })}
      </p>
      <Actions subscription={subscription} open={open} onToggle={() => setOpen(!open)} />
      {open && <DeliveryLog subscription={subscription.id} />}
    </section>
  );
}

function Actions({ subscription, open, onToggle }: { subscription: Subscription; open: boolean; onToggle: () => void }) {
  const [outcome, setOutcome] = useState<string | null>(null);
  const path = `/subscriptions/${subscription.id}`;
  const run = async (action: () => Promise<string>) => {
    try {
      setOutcome(await action());
    } catch (error) {
      setOutcome(error instanceof ApiError ? error.message : String(error));
    }
    void refetch("/subscriptions");
  };
  const setEnabled = (operation: "enable" | "disable") =>
    run(async () => {
      const [, etag] = await getWithEtag<Subscription>(path);
      await post(`${path}/${operation}`, null, etag);
      return operation === "enable" ? t("enabled") : t("disabledNow");
    });
  const setReports = (reports: ReportInterval | null) =>
    run(async () => {
      const [, etag] = await getWithEtag<Subscription>(path);
      await put(`${path}/reports`, { reports }, etag);
      return reports === null ? t("noReportsAnyMore") : t(reports === "weekly" ? "reportsFromTheNextWeek" : "reportsFromTheNextMonth");
    });
  const sendTest = () =>
    run(async () => {
      const { result, answer } = await post<TestOutcome>(`${path}/test`, null);
      return t("testMessageResult", { result: term(result), answer });
    });
  return (
    <p class="buttons">
      {subscription.state === "active" ? (
        <button type="button" onClick={() => setEnabled("disable")}>
          {t("disable")}
        </button>
      ) : (
        <button type="button" onClick={() => setEnabled("enable")}>
          {t("enable")}
        </button>
      )}
      <button type="button" onClick={sendTest}>
        {t("sendATest")}
      </button>
      {CHANNELS.find((one) => one.kind === subscription.kind)?.reports && (
        <label>
          {t("reportsAsPdf")} <ReportSelect value={subscription.reports} onChoose={setReports} />
        </label>
      )}
      <button type="button" class="quiet" aria-expanded={open} onClick={onToggle}>
        {t("deliveriesOf", { sign: open ? "▾" : "▸" })}
      </button>
      <span role="status">{outcome}</span>
    </p>
  );
}

function DeliveryLog({ subscription }: { subscription: number }) {
  const result = useResource<Delivery[]>(`/subscriptions/${subscription}/deliveries?limit=${LOG_LIMIT}`, 5000);
  return (
    <Loaded result={result} lines={LOG_LIMIT}>
      {(all) =>
        all.length === 0 ? (
          <Empty>{t("noDeliveriesYet")}</Empty>
        ) : (
          <Scroll label={t("table")}>
            <table>
              <thead>
                <tr>
                  <th>{t("event")}</th>
                  <th>{t("alert")}</th>
                  <th>{t("state")}</th>
                  <th class="number">{t("attempts")}</th>
                  <th>{t("lastAttempt")}</th>
                  <th>{t("response")}</th>
                </tr>
              </thead>
              <tbody>
                {all.map((one) => (
                  <tr key={one.id}>
                    <td>{one.event}</td>
                    <td>{one.alert}</td>
                    <td>{words(one.state)}</td>
                    <td class="number">{one.attempts}</td>
                    <td>
                      <Time at={one.last_try_at} />
                    </td>
                    <td>{one.answer ?? "–"}</td>
                  </tr>
                ))}
              </tbody>
            </table>
            <Truncated shown={all.length} limit={LOG_LIMIT} />
          </Scroll>
        )
      }
    </Loaded>
  );
}
