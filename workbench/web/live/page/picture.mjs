// A picture of the page for a paper or a slide: the rod, the colour code, and every value that made it.

import { css, pushColour, wordsOf } from "./colours.mjs";
import { make, putPixels } from "./details.mjs";
import { quantityOf } from "./rod_case.mjs";
import { PUSH, minus, number, stated, withUnit } from "./text.mjs";

export const WIDE = 2400;
const HIGH = 1800,
  SIDE = 700,
  EDGE = 70,
  LETTER = 34,
  LINE = 54;
const INK = "#1c2430",
  SOFT = "#4d5866",
  PAPER = "#ffffff",
  FONT = 'system-ui, "DejaVu Sans", sans-serif';

/* The picture as a PNG file. rows: name and text of each value; read: the reading of Table 1 in words. */
export async function drawPicture({ view, shape, code, rows, quantities, state, title, read }) {
  const canvas = make("canvas", { width: WIDE, height: HIGH }),
    ctx = canvas.getContext("2d");
  ctx.fillStyle = PAPER;
  ctx.fillRect(0, 0, WIDE, HIGH);
  const [w, h] = [WIDE - SIDE - 2 * EDGE, HIGH - 2 * EDGE];
  if (view.scene) {
    const part = make("canvas", { width: w, height: h });
    putPixels(part, view.pixels(w, h));
    ctx.drawImage(part, EDGE, EDGE);
    view.rest();
  }
  column(ctx, { shape, code, rows, quantities, state, title, read, squeeze: view.drawn.squeeze, scale: view.drawn.scale });
  return new Promise((done) => {
    canvas.toBlob(done, "image/png");
  });
}

function column(ctx, { code, rows, quantities, state, title, read, squeeze, scale, shape }) {
  const x = WIDE - SIDE,
    right = WIDE - EDGE;
  let y = EDGE + 20;
  const text = (words, colour, bold, size = LETTER) => {
    ctx.font = `${bold ? "600 " : ""}${size}px ${FONT}`;
    ctx.fillStyle = colour;
    ctx.textAlign = "left";
    ctx.fillText(words, x, y);
  };
  for (const words of broken(ctx, title, right - x, `600 ${LETTER + 8}px ${FONT}`)) {
    text(words, INK, true, LETTER + 8);
    y += LINE;
  }
  if (read)
    for (const words of broken(
      ctx,
      `Table 1: ${read}`,
      right - x,
      `${LETTER - 6}px ${FONT}`,
    )) {
      text(words, SOFT, false, LETTER - 6);
      y += LINE - 10;
    }
  text(`Rod ${shape.one.side} the cylinder`, SOFT, false, LETTER - 6);
  y += LINE + 16;
  for (const [name, value] of rows) {
    const [symbol, , dimension] = quantities[quantityOf(name)];
    text(symbol, INK, true);
    ctx.font = `${LETTER}px ${FONT}`;
    ctx.fillText(withUnit(minus(value), stated(dimension, state.units, name)[0]), x + 130, y);
    y += LINE;
  }
  legend(ctx, code, x, right, Math.max(y + 40, HIGH - EDGE - 130), scale, state.units, squeeze);
}

function legend(ctx, code, x, right, y, scale, units, squeeze) {
  const wide = right - x,
    [unit, size] = stated(PUSH, units),
    { low, end } = scale;
  for (let k = 0; k < wide; k++) {
    ctx.fillStyle = css(pushColour(code, low + ((end - low) * k) / (wide - 1), end));
    ctx.fillRect(x + k, y, 1.5, 40);
  }
  ctx.fillStyle = INK;
  ctx.font = `${LETTER - 4}px ${FONT}`;
  ctx.textAlign = "left";
  ctx.fillText(number(low * size, 3), x, y + 78);
  ctx.textAlign = "right";
  ctx.fillText(number(end * size, 3), right, y + 78);
  ctx.textAlign = "left";
  ctx.fillText(minus(wordsOf(code, scale, unit)), x, y + 122);
  if (squeeze < 1) ctx.fillText(`axis compressed 1 : ${(1 / squeeze).toPrecision(3)}`, x, y - 24);
}

function broken(ctx, words, wide, font) {
  ctx.font = font;
  const lines = [""];
  for (const word of words.split(" ")) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (ctx.measureText(longer).width > wide && lines[lines.length - 1]) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}
