// The deviation of the newest identification from its baseline, by element.
import { link } from "../browser/router";
import { ErrorMessage, Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import type { ApiError } from "../data/http-client";
import type { QueryResult } from "../data/resource";
import { elementName } from "../format/names";
import { number } from "../format/numbers";
import type { Document } from "../schemas/machines";
import type { Deviations } from "../schemas/trends";
import { chanceText, CHANGED, changeText, deviationText, largestDeviation } from "../words/deviations";

const TITLE = "Deviation from the baseline";

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
        {(found) => (found.missing ? <Empty>{found.missing}</Empty> : <Table machine={machine.id} found={found} />)}
      </Loaded>
    </Panel>
  );
}

function Compared({ found }: { found: Deviations }) {
  const { baseline } = found;
  return (
    <p class="muted">
      <Time at={found.measured_at} /> {found.run_kind}, against {baseline.identifications.length} runs
      {baseline.since && (
        <>
          {" "}
          since <Time at={baseline.since} />
        </>
      )}
    </p>
  );
}

function Table({ machine, found }: { machine: string; found: Deviations }) {
  const order = [...found.elements].sort((a, b) => a.probability - b.probability || b.distance - a.distance);
  return (
    <Scroll label="Table">
      <table>
        <thead>
          <tr>
            <th>Element</th>
            <th>Largest deviation</th>
            <th class="number" title="all its parameters together, in multiples of how they usually scatter">
              Of usual scatter
            </th>
            <th title="by the probability of as much without any change">Has it changed?</th>
          </tr>
        </thead>
        <tbody>
          {order.map((one) => (
            <Row key={one.element} machine={machine} found={found} one={one} />
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function Row({ machine, found, one }: { machine: string; found: Deviations; one: Deviations["elements"][number] }) {
  const largest = largestDeviation(found, one.element);
  return (
    <tr>
      <td>
        {one.probability < CHANGED && (
          <span class="severity changed" title="changed">
            ●{" "}
          </span>
        )}
        <a href={link(["machines", machine, "trends"], { element: one.element })}>{elementName(one.element)}</a>
      </td>
      <td>{largest ? deviationText(largest) : "–"}</td>
      <td class="number">{number(one.distance / Math.sqrt(one.degrees_of_freedom), 2)} times</td>
      <td title={`an unchanged element is as far in ${chanceText(one.probability)} runs`}>{changeText(one.probability)}</td>
    </tr>
  );
}
