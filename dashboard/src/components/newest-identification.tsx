// The states of a view of the newest identification: being loaded, stale, none.
import type { ApiError } from "../data/http-client";
import { isComparable, MAX_SEARCH, type NewestIdentification, type NewestSummary } from "../data/newest-identification";
import { t } from "../messages/messages";
import { ErrorMessage, Loading, StaleNotice } from "./loading";
import { Empty, Panel } from "./panel";

/** Placeholder of a view whose identification is not loaded yet. */
export function PendingPanel({ title, failure }: { title: string; failure: ApiError | undefined }) {
  return <Panel title={title}>{failure?.isLocal ? <ErrorMessage failure={failure} /> : <Loading height="420px" />}</Panel>;
}

/** Notice above a view: why it does not show the next identification, or that the list is stale. */
export function NewestNotice({ failure, list }: Pick<NewestIdentification, "failure" | "list">) {
  return failure?.isLocal ? <ErrorMessage failure={failure} /> : <StaleNotice result={list} />;
}

export function NoIdentification() {
  return (
    <Panel title={t("nothingToShowYet")}>
      <Empty>{t("noRunOfThisMachine")}</Empty>
    </Panel>
  );
}

/** State that no identification can be compared with a baseline; null where one can, or nothing is known yet. */
export function notComparableText({ data, searched }: NewestSummary): string | null {
  if (data === undefined || isComparable(data)) return null;
  if (searched === MAX_SEARCH) return t("ofTheNewestIdentificationsNone", { count: MAX_SEARCH });
  return t("noIdentificationOfASingle");
}
