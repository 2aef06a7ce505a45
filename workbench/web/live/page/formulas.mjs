// Tables and formulas of the solver, written by benchmarks/make_page_formulas.py: change them there.
// v: fields of a case by name; A, C, rho, and the loads FZ, MZ and M3; the numbers of its problem; what is measured.

export const TWISTS = ["F1", "dgamma", "M3"];

export const DIRECT = ["EI", "GJ"];

export const ELASTIC = ["E", "nu"];

export const ANGLES = ["inclination", "beta", "alpha", "gamma", "beta0", "betaL", "azimuth", "rotation", "tilt0", "tiltL", "lay", "hole"];

export const SLIDING = ["forward", "backward", "rotating", "axial-forward", "axial-backward"];

export const SIDES = {"outside": 1, "inside": -1};

export const HELD = {"beta0": "M10", "betaL": "M1L", "FZ": "height", "MZ": "azimuth", "M3": "rotation"};

export const RANGES = {"E": {"low": 0, "closed": false}, "nu": {"low": -1, "closed": false, "high": 0.5}, "a": {"low": 0, "closed": false}, "L": {"low": 0, "closed": false}, "inner_radius": {"low": 0, "closed": true}, "EI": {"low": 0, "closed": false}, "GJ": {"low": 0, "closed": false}, "weight": {"low": 0, "closed": true}, "R": {"low": 0, "closed": false}, "inclination": {"low": 0, "closed": true, "high": 3.1415926535897967}, "friction": {"low": 0, "closed": true}, "radius0": {"low": 0, "closed": true}, "radiusL": {"low": 0, "closed": true}, "tilt0": {"low": -1.5707963267948966, "closed": true, "high": 1.5707963267948966}, "tiltL": {"low": -1.5707963267948966, "closed": true, "high": 1.5707963267948966}};

export const LENGTHS = {"nm": 1e-09, "um": 1e-06, "mm": 0.001, "cm": 0.01, "dm": 0.1, "m": 1.0, "km": 1000.0, "in": 0.0254, "ft": 0.3048};

export const FORCES = {"pN": 1e-12, "nN": 1e-09, "uN": 1e-06, "mN": 0.001, "N": 1.0, "daN": 10.0, "kN": 1000.0, "MN": 1000000.0, "dyn": 1e-05, "gf": 0.00980665, "kgf": 9.80665, "lbf": 4.4482216152605, "klbf": 4448.2216152605, "kip": 4448.2216152605};

export const LINEAR = [[10000.0, 0.0025], [1000.0, 0.01], [0.0, 0.1]];

export const HABITS = [[[1, 0, 0], ["ft"], [], ["a", "inner_radius", "R", "rho"], "in", 0.0254], [[-2, 1, 0], ["ft", "in"], ["lbf"], [], "psi", 6894.757293168361], [[-2, 1, 0], ["ft", "in"], ["klbf", "kip"], [], "ksi", 6894757.293168361], [[-2, 1, 0], ["m", "km"], ["N", "daN", "kN", "MN", "kgf"], [], "MPa", 1000000.0], [[-2, 1, 0], ["mm"], ["N"], [], "MPa", 1000000.0], [[-1, 1, 0], ["ft"], ["klbf", "kip"], [], "lbf/ft", 14.593902937206362], [[-1, 1, 0], ["in"], ["klbf", "kip"], [], "lbf/in", 175.12683524647636], [[-1, 0, 0], ["ft"], [], [], "deg/100 ft", 0.000572614583987641], [[-1, 0, 1], ["ft"], [], [], "deg/100 ft", 0.000572614583987641]];

export const RHO = {
  outside: (v) => v.R + (1 * v.a),
  inside: (v) => v.R + (-1 * v.a),
};

export const BENDING = {
  solid: (v) => (0.7853981633974483 * v.E) * (((v.a - v.inner_radius) * (v.a + v.inner_radius)) * ((v.a * v.a) + (v.inner_radius * v.inner_radius))),
  paper: (v) => (0.19634954084936207 * v.E) * (((v.a - v.inner_radius) * (v.a + v.inner_radius)) * ((v.a * v.a) + (v.inner_radius * v.inner_radius))),
  given: (v) => v.EI,
};

export const TORSION = {
  solid: (v) => v.A / (1 + v.nu),
  paper: (v) => v.A / (1 + v.nu),
  given: (v) => v.GJ,
};

export const LOADS = {
  F1: (v) => ({
    FZ: (v.F2 * Math.sin(v.beta)) + (v.F3 * Math.cos(v.beta)),
    MZ: (v.rho * (((-v.F2) * Math.cos(v.beta)) + (v.F3 * Math.sin(v.beta)))) + (v.A * ((((v.F1 / (v.A * v.dbeta)) + (((3 * Math.sin(v.beta)) * Math.cos(v.beta)) / v.rho)) * Math.cos(v.beta)) + (Math.sin(v.beta) ** 3 / v.rho))),
    M3: v.A * ((v.F1 / (v.A * v.dbeta)) + (((3 * Math.sin(v.beta)) * Math.cos(v.beta)) / v.rho)),
  }),
  dgamma: (v) => ({
    FZ: (v.F2 * Math.sin(v.beta)) + (v.F3 * Math.cos(v.beta)),
    MZ: (v.rho * (((-v.F2) * Math.cos(v.beta)) + (v.F3 * Math.sin(v.beta)))) + (v.A * ((((v.dgamma + ((Math.sin(v.beta) * Math.cos(v.beta)) / v.rho)) / (v.A / v.C)) * Math.cos(v.beta)) + (Math.sin(v.beta) ** 3 / v.rho))),
    M3: v.A * ((v.dgamma + ((Math.sin(v.beta) * Math.cos(v.beta)) / v.rho)) / (v.A / v.C)),
  }),
  M3: (v) => ({
    FZ: (v.F2 * Math.sin(v.beta)) + (v.F3 * Math.cos(v.beta)),
    MZ: (v.rho * (((-v.F2) * Math.cos(v.beta)) + (v.F3 * Math.sin(v.beta)))) + (v.A * (((v.M3 / v.A) * Math.cos(v.beta)) + (Math.sin(v.beta) ** 3 / v.rho))),
    M3: v.M3,
  }),
};

export const OBSERVED = {
  FZ: (v) => v.FZ,
  MZ: (v) => v.MZ,
  M3: (v) => v.M3,
  amplitude: (v) => v.high - v.low,
  turns_around: (v) => v.turned / 6.283185307179586,
  height: (v) => v.risen * v.rho,
  kappa_mean: (v) => v.curvature * (1 / (v.span * v.rho)),
  kappa_max: (v) => v.tightest * (1 / v.rho),
  contact_size_mean: (v) => (v.pushed * (v.A / (v.rho ** 3 * v.span))) + (v.pulled * (v.A / (v.rho ** 3 * v.span))),
  push_mean: (v) => v.pushed * (v.A / (v.rho ** 3 * v.span)),
  pull_mean: (v) => v.pulled * (v.A / (v.rho ** 3 * v.span)),
  push_min: (v) => v.least * (v.A / v.rho ** 3),
  push_max: (v) => v.most * (v.A / v.rho ** 3),
  push_max_at: (v) => v.peak * v.rho,
  push_middle: (v) => v.middle_push * (3 * (v.A / (v.rho ** 3 * v.span))),
  attached: (v) => v.share * (1 / v.span),
  lift_off_at: (v) => v.lifts * v.rho,
  F3_size_max: (v) => v.tension * (v.A / v.rho ** 2),
  bending_moment_max: (v) => v.tightest * (v.A / v.rho),
  bending_stress_max: (v) => v.tightest * ((v.E * v.a) / v.rho),
  energy: (v) => (v.potential * (v.A / v.rho)) - (((v.A / v.rho) * ((v.mu ** 2 * (v.A / v.C)) / 2)) * v.span),
  bending_energy: (v) => v.bending * (v.A / v.rho),
  twist_energy: (v) => ((v.A / v.rho) * ((v.mu ** 2 * (v.A / v.C)) / 2)) * v.span,
};

export const problemOf = (v) => ({
  lam: (v.MZ / v.A) * v.rho,
  mu: (v.M3 / v.A) * v.rho,
  phi: ((v.FZ / v.A) * v.rho) * v.rho,
  span: v.L / v.rho,
  beta0: v.beta,
  dbeta0: v.dbeta * v.rho,
});

export const potential = (v, beta) => (((2 * (v.lam - (v.mu * Math.cos(beta)))) - Math.sin(beta) ** 3) * Math.sin(beta)) + ((2 * v.phi) * Math.cos(beta));
