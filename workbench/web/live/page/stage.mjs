// A view of the rod with what stands about it: triad, scale, bar of colours, badges, two buttons.

import { set } from "./details.mjs";
import { showBar } from "./push_bar.mjs";
import { makeView } from "./rod_view.mjs";
import { showScale } from "./scale_bar.mjs";
import { crossings } from "./self_contact.mjs";
import { drawTriad } from "./triad.mjs";

/* The stage in a canvas. part: the element of a name. unit: that of length. The others: as of `makeView`. */
export function makeStage(canvas, mark, part, code, calm, unit, lies = false) {
  const view = makeView(canvas, mark, code, calm, lies);
  view.moved = (camera) => {
    drawTriad(part("triad"), camera);
    showScale(part("scale"), view, canvas, unit());
  };
  for (const name of ["fit", "front"]) part(name).addEventListener("click", () => view[name]());

  /* The colours of what is drawn, and whether its axis is compressed. push: the unit of the push. */
  function showLegend(push) {
    const { squeeze, scale } = view.drawn;
    part("squeeze").hidden = squeeze >= 1;
    set(part("squeeze"), `Axis compressed 1 : ${(1 / squeeze).toPrecision(3)}`);
    showBar(part("bar"), code, scale, push);
  }

  /* Ring the places where a shape passes through itself, which takes longer than a move of a slider may; these places. */
  function showCrossings(shape) {
    const crossed = crossings(shape);
    view.setRings(crossed);
    part("crossed").hidden = !crossed.length;
    return crossed;
  }

  return { view, showLegend, showCrossings };
}
