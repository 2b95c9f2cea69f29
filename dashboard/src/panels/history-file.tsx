// The data of histories as a file.
import { useState } from "preact/hooks";
import { csvFile, download, localCsv } from "../browser/download";
import { joinedCsv, type MachineFile } from "../data/machine-files";
import { t } from "../messages/messages";

/** Button that saves histories as CSV in the form of the page's language; of two machines, with a column that names them. */
export function HistoryFile({ files, element }: { files: MachineFile[]; element: string }) {
  const [failure, setFailure] = useState<string | null>(null);
  const name = `${files.map((one) => one.machine).join("-")}-${element}.csv`;
  const save = async () => {
    try {
      download(csvFile(localCsv(await joinedCsv(files))), name);
      setFailure(null);
    } catch (error) {
      setFailure(String(error instanceof Error ? error.message : error));
    }
  };
  return (
    <span class="screen">
      <button type="button" title={t("saveTheDataAsCsv")} onClick={() => void save()}>
        CSV
      </button>
      {failure && <span role="alert"> {failure}</span>}
    </span>
  );
}
