// Files of the API of several machines as one, with a column that names the machine.
import { getText } from "./http-client";

export interface MachineFile {
  machine: string;
  /** Path of its CSV file. */
  path: string;
}

/** CSV files with the same columns as one; a single one as it is. */
export async function joinedCsv(files: MachineFile[]): Promise<string> {
  if (files.length === 1) return getText(files[0]!.path);
  const texts = await Promise.all(files.map((one) => getText(one.path)));
  const lines = texts.map((text) => text.split(/\r?\n/).filter(Boolean));
  const rows = lines.flatMap((all, place) => all.slice(1).map((line) => `${files[place]!.machine},${line}`));
  return [`machine,${lines[0]![0] ?? ""}`, ...rows].join("\r\n") + "\r\n";
}
