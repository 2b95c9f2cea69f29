// The correlation of an identification's estimates: the matrix, and the pairs that the data hardly distinguish.
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { useResource } from "../data/resource";
import { parameterName } from "../format/names";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import { CorrelationMatrix } from "../plots/correlation-matrix";
import type { Correlation } from "../schemas/identifications";

/** Pairs that are listed. */
const MAX_PAIRS = 12;

export function CorrelationPanel({ identification }: { identification: string }) {
  const result = useResource<Correlation>(`/identifications/${identification}/correlation`);
  return (
    <Panel title={t("correlationOfTheEstimates")}>
      <Loaded result={result} lines={20}>
        {(found) => (
          <div class="columns">
            <CorrelationMatrix key={identification} found={found} />
            <Pairs found={found} />
          </div>
        )}
      </Loaded>
    </Panel>
  );
}

function Pairs({ found }: { found: Correlation }) {
  if (found.strongest.length === 0) return <Empty>{t("noTwoAreCorrelated")}</Empty>;
  return (
    <div>
      <p>{t("dataHardlyDistinguish")}</p>
      <ul class="reasons">
        {found.strongest.slice(0, MAX_PAIRS).map((one) => (
          <li key={`${one.one} ${one.other}`}>
            {t("pairWithCorrelation", { one: parameterName(one.one), other: parameterName(one.other), correlation: number(one.correlation, 3) })}
          </li>
        ))}
      </ul>
      {found.strongest.length > MAX_PAIRS && <p class="muted">{t("strongestPairsShown", { shown: MAX_PAIRS, all: found.strongest.length })}</p>}
    </div>
  );
}
