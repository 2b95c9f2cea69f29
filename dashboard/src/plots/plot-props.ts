// The properties of a plot: its curves, markers and bands.

export interface Curve {
  name: string;
  y: (number | null)[];
  /** Number of its colour and dash; by default its place. */
  style?: number;
  points?: boolean;
  line?: boolean;
  /** Bounds around it, drawn as a band. */
  lower?: (number | null)[];
  upper?: (number | null)[];
  /** Paler, to compare the others with. */
  faint?: boolean;
  /** Joined across points that only other curves have. */
  spanGaps?: boolean;
  /** Neither in the legend nor read out: it belongs to another curve. */
  unlisted?: boolean;
}

export interface Marker {
  x: number;
  kind: "alert" | "danger" | "maintenance" | "note" | "speed";
  words: string;
}

/** A range that y should lie in, over a stretch of x. */
export interface Band {
  low: number;
  high: number;
  from: number;
  /** Null: to the right edge. */
  to: number | null;
}

/** A limit, drawn as a horizontal line over the whole width. */
export interface LimitLine {
  y: number;
  kind: "alert" | "danger" | "note";
  words: string;
}

export interface PlotProps {
  label: string;
  x: number[];
  curves: Curve[];
  /** Seconds since 1970 along x, shown as local time. */
  time?: boolean;
  xUnit?: string;
  yUnit: string;
  xRange?: [number, number];
  yRange?: [number, number];
  bands?: Band[];
  limits?: LimitLine[];
  /** Values are angles: they are read out from 0 to this, however many turns a curve has gone. */
  turn?: number;
  markers?: Marker[];
  height?: number;
  /** Plots of one group share cursor and zoom. */
  syncGroup?: string;
  /** The text read out at a point; by default every curve's value. */
  readOut?: (index: number) => string;
  onPick?: (index: number) => void;
}
