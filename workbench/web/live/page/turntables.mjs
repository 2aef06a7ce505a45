// Every turntable of a page begins once it comes near the screen.

import { coreOf } from "./packed_core.mjs";
import { numbersOf } from "./rod_sources.mjs";
import { turntable } from "./turntable.mjs";

const data = JSON.parse(document.getElementById("data").textContent),
  calm = window.matchMedia("(prefers-reduced-motion: reduce)");
for (const one of Object.values(data.figures)) if (one.arrays) one.arrays = numbersOf(one.arrays);

async function begin(figure) {
  const one = data.figures[figure.id];
  const core = await coreOf(data.core);
  turntable(figure, { ...one, ...data.words }, data.colours, core, () => calm.matches);
}

const watch = new IntersectionObserver(
  (seen) => {
    for (const { target, isIntersecting } of seen) {
      if (!isIntersecting) continue;
      watch.unobserve(target);
      begin(target);
    }
  },
  { rootMargin: "300px" },
);
for (const figure of document.querySelectorAll("figure.turntable")) watch.observe(figure);
