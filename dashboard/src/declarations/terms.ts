// Written by `python -m service.commands.page_declarations` from estimator/bearings/terms.py; not to be changed here.

export type TermQuantity = "stiffness" | "damping" | "angular stiffness" | "angular damping" | "coupled stiffness" | "inertia";

/** direct: positive by nature, unlike a cross-coupled term. order: power of jω with which it acts. */
export interface Term {
  quantity: TermQuantity;
  direct: boolean;
  order: number;
}

/** Terms of the coefficients of bearings, seals, couplings and pedestals, by name. */
export const TERMS: Readonly<Record<string, Term>> = {
  kxx: { quantity: "stiffness", direct: true, order: 0 },
  kxy: { quantity: "stiffness", direct: false, order: 0 },
  kyx: { quantity: "stiffness", direct: false, order: 0 },
  kyy: { quantity: "stiffness", direct: true, order: 0 },
  cxx: { quantity: "damping", direct: true, order: 1 },
  cxy: { quantity: "damping", direct: false, order: 1 },
  cyx: { quantity: "damping", direct: false, order: 1 },
  cyy: { quantity: "damping", direct: true, order: 1 },
  k_phix: { quantity: "angular stiffness", direct: true, order: 0 },
  k_phiy: { quantity: "angular stiffness", direct: true, order: 0 },
  k_phixy: { quantity: "angular stiffness", direct: false, order: 0 },
  k_phiyx: { quantity: "angular stiffness", direct: false, order: 0 },
  c_phix: { quantity: "angular damping", direct: true, order: 1 },
  c_phiy: { quantity: "angular damping", direct: true, order: 1 },
  kx_phiy: { quantity: "coupled stiffness", direct: false, order: 0 },
  ky_phix: { quantity: "coupled stiffness", direct: false, order: 0 },
  mxx: { quantity: "inertia", direct: true, order: 2 },
  myy: { quantity: "inertia", direct: true, order: 2 },
};
