// The data of histories as a file.
import { useState } from "preact/hooks";
import { download } from "../browser/download";
import { API_PREFIX } from "../data/http-client";
import { joinedCsv, type MachineFile } from "../data/machine-files";
import { t } from "../messages/messages";

/** As the API sends it, of two machines with a column that names them. */
export function HistoryFile({ files, element }: { files: MachineFile[]; element: string }) {
  const [failure, setFailure] = useState<string | null>(null);
  const [first] = files;
  const name = `${files.map((one) => one.machine).join("-")}-${element}.csv`;
  if (files.length === 1) {
    return (
      <a class="screen" href={API_PREFIX + first!.path} download={name}>
        CSV
      </a>
    );
  }
  const save = async () => {
    try {
      download(new Blob([await joinedCsv(files)], { type: "text/csv;charset=utf-8" }), name);
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
