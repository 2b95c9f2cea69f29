// The newest identification beside the baseline, element by element.
import type { Deviations, Document } from "../schemas/answers";
import type { Failure } from "../data/http-client";
import { CHANGED, inWords, largest } from "../train/marks";
import { elementName, number } from "../words/format";
import { Empty, Panel, Shown, Time, Trouble } from "../components/parts";
import type { Answer } from "../data/resource";
import { link } from "../browser/router";

interface Props {
  machine: Document;
  answer: Answer<Deviations>;
  /** Why the next one is not there yet. */
  next: Failure | undefined;
  /** Why there is nothing to compare, where that is known. */
  none: string | null;
}

export function DeviationsPanel({ machine, answer, next, none }: Props) {
  if (none !== null) {
    return (
      <Panel title="Against the baseline">
        <Empty>{none}</Empty>
      </Panel>
    );
  }
  return (
    <Panel title="Against the baseline" aside={answer.data && <About found={answer.data} />}>
      {next?.own && <Trouble failure={next} />}
      <Shown answer={answer} lines={12}>
        {(found) => (found.missing ? <Empty>{found.missing}</Empty> : <Table machine={machine.id} found={found} />)}
      </Shown>
    </Panel>
  );
}

function About({ found }: { found: Deviations }) {
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
    <div class="scroll">
      <table>
        <thead>
          <tr>
            <th>Element</th>
            <th>Largest of its parameters</th>
            <th class="number" title="how far all of its parameters moved together, over what is usual">
              Distance
            </th>
            <th class="number">By chance</th>
          </tr>
        </thead>
        <tbody>
          {order.map((one) => {
            const most = largest(found, one.element);
            return (
              <tr key={one.element}>
                <td>
                  {one.probability < CHANGED && (
                    <span class="severity changed" title="changed">
                      ●{" "}
                    </span>
                  )}
                  <a href={link(["machines", machine, "trends"], { element: one.element })}>{elementName(one.element)}</a>
                </td>
                <td>{most ? inWords(most) : "–"}</td>
                <td class="number">{number(one.distance / Math.sqrt(one.degrees_of_freedom), 2)}</td>
                <td class="number">
                  {one.probability < 1e-9 ? "< 10⁻⁹" : number(one.probability, 2)}
                </td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}
