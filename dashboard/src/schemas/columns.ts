// Columns of numbers, as the API sends them.

/** Values in a column's order; null where there is none. */
export type Column = (number | null)[];
