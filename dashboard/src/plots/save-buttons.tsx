// Buttons that save a plot as a picture, and its data.
import { saveCsv, savePng, saveSvg, svgText, type DataColumn } from "../browser/download";
import { cssColour } from "../browser/theme";
import { t } from "../messages/messages";

interface Props {
  /** Label of the plot, after which the files are named. */
  label: string;
  columns: () => DataColumn[];
}

/** Buttons that save a plot drawn on a canvas. */
export function SaveButtons({ label, columns, canvas }: Props & { canvas: () => HTMLCanvasElement | undefined }) {
  const save = () => {
    const found = canvas();
    if (found) savePng(label, found, cssColour("inset"));
  };
  return <Buttons label={label} columns={columns} kind="PNG" onSave={save} />;
}

/** Buttons that save the drawing in the same figure. */
export function SaveDrawing({ label, columns }: Props) {
  const save = (event: Event) => {
    const found = (event.currentTarget as HTMLElement).closest("figure")?.querySelector("svg");
    if (found) saveSvg(label, svgText(found));
  };
  return (
    <span class="saves screen">
      <Buttons label={label} columns={columns} kind="SVG" onSave={save} />
    </span>
  );
}

/** Buttons that save what is drawn with elements of the page: the picture is made when it is asked for. */
export function SavePicture({ label, columns, picture }: Props & { picture: () => string }) {
  return (
    <span class="saves screen">
      <Buttons label={label} columns={columns} kind="SVG" onSave={() => saveSvg(label, picture())} />
    </span>
  );
}

function Buttons({ label, columns, kind, onSave }: Props & { kind: string; onSave: (event: Event) => void }) {
  return (
    <>
      <button type="button" aria-label={t("saveAsLabel", { kind, label })} title={t("saveAs", { kind })} onClick={onSave}>
        {kind}
      </button>
      <button type="button" aria-label={t("saveDataLabel", { label })} title={t("saveTheDataAsCsv")} onClick={() => saveCsv(label, columns())}>
        CSV
      </button>
    </>
  );
}
