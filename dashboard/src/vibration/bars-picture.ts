// The bars of the newest vibration as a picture to be saved: on the page they are drawn with its own means, without one.
import { cssColour } from "../browser/theme";

/** A bar of a probe, in parts of the longest one. */
export interface PictureBar {
  channel: string;
  level: string;
  reading: string;
  first: number | null;
  second: number | null;
  overall: number | null;
}

/** A line across all bars, in parts of the longest one. */
export interface PictureLine {
  at: number;
  kind: "alert" | "danger" | "boundary";
}

const WIDTH = 760;
const LEFT = 70;
const LENGTH = 330;
const ROW = 26;
const FILLS: Record<string, string> = { alert: "alert-fill", danger: "danger" };
const LINES: Record<PictureLine["kind"], string> = { alert: "alert", danger: "danger", boundary: "text" };

export function barsPicture(title: string, bars: PictureBar[], lines: PictureLine[], signs: string): string {
  const height = ROW * (bars.length + 2);
  const bar = (part: number | null, top: number, thick: number, colour: string) =>
    part === null ? "" : `<rect x="${LEFT}" y="${top}" width="${(LENGTH * part).toFixed(1)}" height="${thick}" fill="${cssColour(colour)}"/>`;
  const text = (x: number, y: number, content: string, colour = "text") => `<text x="${x}" y="${y}" fill="${cssColour(colour)}">${escaped(content)}</text>`;
  const rows = bars.map((one, at) => {
    const top = ROW * (at + 1) + 4;
    return [
      text(8, top + 11, one.channel),
      bar(one.first, top, 9, FILLS[one.level] ?? "edge"),
      bar(one.second, top + 10, 4, "faint"),
      bar(one.overall, top + 15, 3, "text"),
      text(LEFT + LENGTH + 12, top + 11, one.reading),
    ].join("");
  });
  const across = lines.map(({ at, kind }) => {
    const x = (LEFT + LENGTH * at).toFixed(1);
    return `<path d="M${x} ${ROW}V${height - ROW}" stroke="${cssColour(LINES[kind])}" stroke-width="2"${kind === "danger" ? "" : ' stroke-dasharray="4 3"'}/>`;
  });
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${height}" width="${WIDTH}" height="${height}" font-family="sans-serif" font-size="12">`,
    `<rect width="${WIDTH}" height="${height}" fill="${cssColour("panel")}"/>`,
    text(8, 17, title),
    ...across,
    ...rows,
    text(8, height - 9, signs, "muted"),
    "</svg>",
  ].join("");
}

function escaped(text: string): string {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}
