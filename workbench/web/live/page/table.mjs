// The shape as a table of text (CSV).

export function csvText({ one, s, alpha, beta, dbeta, z, push, kappa, tension }, { length, force }) {
  const rows = [
    [
      `s [${length}]`,
      `x [${length}]`,
      `y [${length}]`,
      `z [${length}]`,
      "alpha [rad]",
      "beta [rad]",
      `dbeta [rad/${length}]`,
      `kappa [1/${length}]`,
      `F3 [${force}]`,
      `push [${force}/${length}]`,
    ],
  ];
  for (let i = 0; i < s.length; i++)
    rows.push([
      s[i],
      one.rho * Math.cos(alpha[i]),
      one.rho * Math.sin(alpha[i]),
      z[i],
      alpha[i],
      beta[i],
      dbeta[i],
      kappa[i],
      tension[i],
      push[i],
    ]);
  return `${rows.map((row) => row.join(",")).join("\r\n")}\r\n`;
}
