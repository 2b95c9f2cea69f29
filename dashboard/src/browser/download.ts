// Files made in the browser: pictures of plots, and their data.

export function download(blob: Blob, file: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = file;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A file's name from a plot's label: letters, digits and hyphens. */
export function fileName(label: string, ending: string): string {
  const words = label.normalize("NFKD").replace(/[^A-Za-z0-9.×]+/g, "-").replaceAll("×", "x");
  return `${words.replace(/^-+|-+$/g, "").slice(0, 80).toLowerCase() || "plot"}.${ending}`;
}

export interface DataColumn {
  name: string;
  values: (number | string | null)[];
}

/** Columns as RFC 4180 text: what is missing is empty. */
export function csvText(columns: DataColumn[]): string {
  const cell = (value: number | string | null | undefined) => {
    const text = value === null || value === undefined ? "" : String(value);
    return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  const rows = Math.max(0, ...columns.map((one) => one.values.length));
  const lines = [columns.map((one) => cell(one.name)), ...Array.from({ length: rows }, (_, row) => columns.map((one) => cell(one.values[row])))];
  return lines.map((line) => line.join(",")).join("\r\n") + "\r\n";
}

export function saveCsv(label: string, columns: DataColumn[]): void {
  download(new Blob([csvText(columns)], { type: "text/csv;charset=utf-8" }), fileName(label, "csv"));
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

export function saveSvg(label: string, svg: SVGSVGElement): void {
  download(new Blob([svgText(svg)], { type: "image/svg+xml" }), fileName(label, "svg"));
}
