// A button that has the service print a machine's report, says how long that takes, and saves it.
import { download } from "../browser/download";
import { unitChoice } from "../browser/units";
import { queryString } from "../data/http-client";
import { usePrinting } from "../data/pdf-report";
import { dayOf } from "../format/days";
import { locale } from "../messages/locale";
import { t } from "../messages/messages";

interface Props {
  machine: string;
  /** Null: by default the year until now. */
  from?: string | null;
  to?: string | null;
}

export function PdfButton({ machine, from = null, to = null }: Props) {
  const { seconds, failure, start } = usePrinting();
  const file = `${machine}-${dayOf(to ? new Date(to) : new Date())}.pdf`;
  return (
    <span class="printing">
      <button type="button" disabled={seconds !== null} onClick={() => start(`/machines/${machine}/report.pdf${queryString({ from, to, locale, units: unitChoice.value })}`, (pdf) => download(pdf, file))}>
        {t("reportAsPdf")}
      </button>{" "}
      <span role="status">
        {seconds !== null && (
          <>
            <progress aria-label={t("theReportIsBeingPrinted")} /> {t("beingPrintedS", { seconds })}
          </>
        )}
      </span>
      {failure && (
        <span class="error" role="alert">
          {failure}
        </span>
      )}
    </span>
  );
}
