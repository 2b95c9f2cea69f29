// The deviation of the newest identification from its baseline, by element.
import { link } from "../browser/router";
import { useUnits } from "../browser/units";
import { ErrorMessage, Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import type { ApiError } from "../data/http-client";
import type { QueryResult } from "../data/resource";
import { elementName } from "../format/names";
import { number } from "../format/numbers";
import { rich, stored, t, term } from "../messages/messages";
import type { Document } from "../schemas/machines";
import type { Deviations } from "../schemas/trends";
import { chanceText, CHANGED, changeText, deviationText, largestDeviation, togetherText } from "../words/deviations";

const TITLE = t("deviationFromTheBaseline");

interface Props {
  machine: Document;
  result: QueryResult<Deviations>;
  /** Why those of the next identification are not there yet. */
  next: ApiError | undefined;
  /** Why there is nothing to compare, where that is known. */
  none: string | null;
}

export function DeviationsPanel({ machine, result, next, none }: Props) {
  if (none !== null) {
    return (
      <Panel title={TITLE}>
        <Empty>{none}</Empty>
      </Panel>
    );
  }
  return (
    <Panel title={TITLE} aside={result.data && <Compared found={result.data} />}>
      {next?.isLocal && <ErrorMessage failure={next} />}
      <Loaded result={result} lines={12}>
        {(found) => (found.missing ? <Empty>{t("noChangeAgainstABaseline", { missing: stored(found.missing) })}</Empty> : <DeviationTable machine={machine.id} found={found} />)}
      </Loaded>
    </Panel>
  );
}

function Compared({ found }: { found: Deviations }) {
  const { baseline } = found;
  return (
    <p class="muted">
      {rich("comparedAgainst", { time: <Time at={found.measured_at} />, kind: term(found.run_kind), runs: baseline.identifications.length })}
      {baseline.since && (
        <>
          {" "}
          {rich("sinceTime", { time: <Time at={baseline.since} /> })}
        </>
      )}
    </p>
  );
}

function DeviationTable({ machine, found }: { machine: string; found: Deviations }) {
  const order = [...found.elements].sort((a, b) => a.probability - b.probability || b.distance - a.distance);
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{t("element")}</th>
            <th>{t("largestDeviation")}</th>
            <th class="number" title={t("scatterExplained")}>
              {t("ofUsualScatter")}
            </th>
            <th title={t("byTheProbabilityOfAs")}>{t("hasItChanged")}</th>
          </tr>
        </thead>
        <tbody>
          {order.map((one) => (
            <DeviationRow key={one.element} machine={machine} found={found} one={one} />
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function DeviationRow({ machine, found, one }: { machine: string; found: Deviations; one: Deviations["elements"][number] }) {
  const largest = largestDeviation(found, one.element);
  const together = togetherText(found, one.element, useUnits().length);
  return (
    <tr>
      <td>
        {one.probability < CHANGED && (
          <span class="severity changed" title={t("changed")}>
            ●{" "}
          </span>
        )}
        <a href={link(["machines", machine, "trends"], { element: one.element })}>{elementName(one.element)}</a>
      </td>
      <td>
        {together}
        {largest ? together ? <small class="muted">{t("byItselfLargest", { largest: deviationText(largest) })}</small> : deviationText(largest) : !together && "–"}
      </td>
      <td class="number">{t("timesScatter", { times: number(one.distance / Math.sqrt(one.degrees_of_freedom), 2) })}</td>
      <td title={t("unchangedElementIsAsFar", { chance: chanceText(one.probability) })}>{changeText(one.probability)}</td>
    </tr>
  );
}
