// Curvature, forces, push and potential along a rod, from beta and beta'. As solver/mechanics has them.

/* G(beta) in units of 1/rho^2; eq. (32), corrected. */
export function potential({ lam, mu, phi }, beta) {
  const s = Math.sin(beta),
    c = Math.cos(beta);
  return (2 * (lam - mu * c) - s ** 3) * s + 2 * phi * c;
}

/* beta'' at an angle [1/length^2]. */
export function bend({ A, rho, FZ, MZ, M3 }, beta) {
  const s = Math.sin(beta),
    c = Math.cos(beta);
  return (FZ / A + (2 * c * s * s) / rho ** 2) * s - ((MZ / A) * c - (M3 / A) * Math.cos(2 * beta)) / rho;
}

/* Push [force/length], curvature [1/length] and F3 [force] at every station; eqs. (30), (31), (34), corrected. */
export function forcesAlong(one, beta, dbeta) {
  const { A, rho, FZ, sign } = one,
    n = beta.length,
    l = one.MZ / A,
    m = one.M3 / A;
  const push = new Float64Array(n),
    kappa = new Float64Array(n),
    tension = new Float64Array(n);
  for (let i = 0; i < n; i++) {
    const s = Math.sin(beta[i]),
      c = Math.cos(beta[i]),
      b = dbeta[i];
    const FY = (A / rho) * (l - m * c - s ** 3 / rho),
      H = -bend(one, beta[i]);
    push[i] = sign * ((s * FY) / rho + A * (H * ((3 * s * c) / rho - m) - (3 / rho) * b * b * (c - s) * (c + s)));
    kappa[i] = Math.hypot(b, (s * s) / rho);
    tension[i] = FZ * c + FY * s;
  }
  return { push, kappa, tension };
}
