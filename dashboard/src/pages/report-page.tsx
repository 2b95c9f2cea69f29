// A report of one machine and period, to be printed or saved: what happened, how the parameters developed, what is open.
import { useLayoutEffect } from "preact/hooks";
import { link, route } from "../browser/router";
import { useStore } from "../browser/store";
import { setPrintColours } from "../browser/theme";
import { Loaded } from "../components/loading";
import { MissingMachine } from "../components/missing";
import { Empty, Panel } from "../components/panel";
import { PdfButton } from "../components/pdf-button";
import { PeriodFields } from "../components/period-fields";
import { useResource } from "../data/resource";
import { dayOf, daysLater, isDay, midnight } from "../format/days";
import { date, when } from "../format/times";
import { t } from "../messages/messages";
import { ReportBody } from "../reports/report-body";
import type { Document, MachineRevision } from "../schemas/machines";

const PERIOD_DAYS = 90;
/** Without an offset, which may change within a period. */
const ZONE = Intl.DateTimeFormat().resolvedOptions().timeZone;

/** The errors of a period; empty for a valid one. */
function periodErrors(first: string, last: string): string[] {
  const ends = [[t("periodFirst"), "from", first], [t("periodLast"), "to", last]] as const;
  const invalid = ends.filter(([, , text]) => !isDay(text));
  if (invalid.length === 0 && first > last) return [t("thePeriodSFirstDay")];
  return invalid.map(([which, name, text]) => t("periodDayIsNoDate", { which, name, text }));
}

export function ReportPage({ id }: { id: string }) {
  useLayoutEffect(() => {
    setPrintColours(true);
    return () => setPrintColours(false);
  }, []);
  const result = useResource<MachineRevision>(`/machines/${id}`);
  if (result.failure?.status === 404) return <MissingMachine id={id} />;
  return (
    <Loaded result={result} lines={20}>
      {({ document, revision }) => <Report machine={document} revision={revision} />}
    </Loaded>
  );
}

function Report({ machine, revision }: { machine: Document; revision: number }) {
  const { query } = useStore(route);
  const first = query.get("from") ?? dayOf(daysLater(new Date(), -PERIOD_DAYS));
  const last = query.get("to") ?? dayOf(new Date());
  const errors = periodErrors(first, last);
  if (errors.length > 0) {
    return (
      <Panel title={t("report")}>
        <PeriodChoice first={first} last={last} />
        {errors.map((one) => (
          <Empty key={one}>{one}</Empty>
        ))}
      </Panel>
    );
  }
  const from = midnight(first);
  const to = new Date(daysLater(midnight(last), 1).getTime() - 1);
  return (
    <article class="report">
      <header>
        <p class="buttons screen">
          <a href={link(["machines", machine.id])}>{t("backToTheMachine")}</a>{" "}
          <PdfButton machine={machine.id} from={from.toISOString()} to={to.toISOString()} />
        </p>
        <h1>{machine.name}</h1>
        <p>
          {t("reportHeader", { plant: machine.plant, id: machine.id, revision, from: date(from), to: date(to), created: when(new Date().toISOString()), zone: ZONE })}
        </p>
        <PeriodChoice first={first} last={last} />
      </header>
      <ReportBody machine={machine} from={from.toISOString()} to={to.toISOString()} />
    </article>
  );
}

function PeriodChoice({ first, last }: { first: string; last: string }) {
  return (
    <div class="choices">
      <PeriodFields first={first} last={last} />
      <button type="button" class="strong" onClick={() => window.print()}>
        {t("printOrSaveAsPdf")}
      </button>
    </div>
  );
}
