// Files made in the browser: pictures of plots, and their data.
import { t } from "../messages/messages";

export function download(blob: Blob, file: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = file;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A file's name from a plot's label: letters, digits and hyphens. */
export function fileName(label: string, ending: string): string {
  const words = label.replaceAll("ß", "ss").normalize("NFKD").replace(/\p{M}/gu, "").replace(/[^A-Za-z0-9.×]+/g, "-").replaceAll("×", "x");
  return `${words.replace(/^-+|-+$/g, "").slice(0, 80).toLowerCase() || "plot"}.${ending}`;
}

/** A character that begins a formula of a spreadsheet, which the text of a cell must not. */
const FORMULA = /^'*[=+\-@\t\r\n＝＋－＠]/;

export interface DataColumn {
  name: string;
  values: (number | string | null)[];
}

/**
 * Columns as text that the spreadsheets of the page's language open as numbers: where the decimal mark is a comma, cells are
 * parted by semicolons. What is missing is empty.
 */
export function csvText(columns: DataColumn[]): string {
  const mark = t("decimalMark");
  const separator = csvSeparator();
  const cell = (value: number | string | null | undefined) => {
    if (value === null || value === undefined) return "";
    if (typeof value === "number") return String(value).replace(".", mark);
    const text = FORMULA.test(value) ? `'${value}` : value;
    return /[",;\t\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  const rows = Math.max(0, ...columns.map((one) => one.values.length));
  const lines = [columns.map((one) => cell(one.name)), ...Array.from({ length: rows }, (_, row) => columns.map((one) => cell(one.values[row])))];
  return lines.map((line) => line.join(separator)).join("\r\n") + "\r\n";
}

function csvSeparator(): string {
  return t("decimalMark") === "," ? ";" : ",";
}

/** A file's text as a file: with a mark by which spreadsheets know that it is UTF-8, where their language expects our form. */
export function csvFile(text: string): Blob {
  return new Blob([t("decimalMark") === "," ? "\ufeff" : "", text], { type: "text/csv;charset=utf-8" });
}

const CELLS = /("(?:[^"]|"")*"|[^,\r\n]*)(,|\r?\n|$)/g;
const DECIMAL = /^-?\d+\.\d+(?:e[+-]?\d+)?$/i;

/** A CSV file of the API in the form of the page's language; its column names stay. */
export function localCsv(text: string): string {
  const separator = csvSeparator();
  if (separator === ",") return text;
  return text.replace(CELLS, (_, cell: string, end: string) => {
    const text = DECIMAL.test(cell) ? cell.replace(".", ",") : cell.includes(separator) && !cell.startsWith('"') ? `"${cell}"` : cell;
    return text + (end === "," ? separator : end);
  });
}

export function saveCsv(label: string, columns: DataColumn[]): void {
  download(csvFile(csvText(columns)), fileName(label, "csv"));
}

/** A canvas as PNG, on the page's background. */
export function savePng(label: string, canvas: HTMLCanvasElement, background: string): void {
  const copy = document.createElement("canvas");
  Object.assign(copy, { width: canvas.width, height: canvas.height });
  const context = copy.getContext("2d")!;
  context.fillStyle = background;
  context.fillRect(0, 0, copy.width, copy.height);
  context.drawImage(canvas, 0, 0);
  copy.toBlob((blob) => blob && download(blob, fileName(label, "png")), "image/png");
}

/** What the style sheets give to a drawing; a file must say it itself. */
const STYLES = ["color", "fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "opacity", "font-family", "font-size", "font-weight", "text-anchor"];

/** A drawing with its colours and lines in itself. */
export function svgText(svg: SVGSVGElement): string {
  const copy = svg.cloneNode(true) as SVGSVGElement;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  const box = svg.viewBox.baseVal;
  copy.setAttribute("width", String(2 * box.width));
  copy.setAttribute("height", String(2 * box.height));
  const copies = [copy, ...copy.querySelectorAll("*")];
  [svg, ...svg.querySelectorAll("*")].forEach((one, at) => {
    const styles = getComputedStyle(one);
    // As attributes: the page's security policy allows no styles in elements.
    for (const name of STYLES) copies[at]!.setAttribute(name, styles.getPropertyValue(name));
  });
  return new XMLSerializer().serializeToString(copy);
}

export function saveSvg(label: string, svg: string): void {
  download(new Blob([svg], { type: "image/svg+xml" }), fileName(label, "svg"));
}
