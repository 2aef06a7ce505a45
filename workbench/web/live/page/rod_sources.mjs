// Where the rods of a turntable come from: the cases of a file, or a start problem that is solved in this page.

import { placeOf, spanOf, valueAt } from "./controls.mjs";
import { bytesOf } from "./packed_core.mjs";
import { Refused, caseOf, quantityOf } from "./rod_case.mjs";
import { interpolated, marched } from "./rod_shape.mjs";
import { observables, warnings } from "./numbers.mjs";
import { PUSH, inUnit, minus, stated } from "./text.mjs";

const ROWS = ["beta", "dbeta", "alpha", "z"]; // of the stored arrays of a case

/* The shape of a stored case. data: the plain data of `turntable_page.turntable_of_dataset`. */
export function storedShape(core, data, index) {
  const n = data.stations.length,
    one = { ...data.shared, ...data.cases[index].numbers };
  const row = (k) => data.arrays.subarray((4 * index + k) * n, (4 * index + k + 1) * n);
  const stations = { s: Float64Array.from(data.stations, (u) => u * one.L) };
  ROWS.forEach((name, k) => (stations[name] = Float64Array.from(row(k))));
  one.kind = "start";
  [one.beta, one.alpha] = [stations.beta[0], stations.alpha[0]];
  return interpolated(core, one, stations, { error: 0, condition: NaN, sound: true, shown: 1 });
}

/* Numbers of four bytes, as a file carries them. */
export const numbersOf = (text) => new Float32Array(bytesOf(text).buffer);

/* The cases of a file: one slider an axis; the case at its places; the words of a place. */
export function storedSource(data, core) {
  const { axes } = data,
    places = axes.map((axis) => axis.start);
  const index = () => axes.reduce((at, axis, k) => at * axis.texts.length + places[k], 0);
  return {
    sliders: axes.map((axis, k) => ({
      words: axis.words,
      symbol: axis.symbol,
      most: axis.texts.length - 1,
      place: () => places[k],
      text: () => axis.texts[places[k]],
      move: (place) => (places[k] = Math.round(place)),
    })),
    now() {
      const one = data.cases[index()];
      return { shape: one.numbers ? storedShape(core, data, index()) : null, note: one.note, rows: one.facts || [] };
    },
    reset: () => axes.forEach((axis, k) => (places[k] = axis.start)),
  };
}

/* A start problem that is solved in this page. data: its state, and the names of the fields that have a slider. */
export function solvedSource(data, core) {
  const begun = JSON.stringify(data.state.base),
    base = JSON.parse(begun),
    letters = data.letters;
  return {
    sliders: data.fields.map((name) => {
      const [symbol, words, dimension] = data.quantities[quantityOf(name)],
        span = spanOf(name, JSON.parse(begun)[name], data.spans[name]),
        unit = stated(dimension, data.state.units, name);
      return {
        words,
        symbol,
        most: 1000,
        step: "any",
        place: () => placeOf(name, base[name], span),
        text: () => inUnit(base[name], unit),
        move: (place) => (base[name] = valueAt(name, place, span)),
      };
    }),
    now() {
      try {
        const shape = marched(core, caseOf({ ...data.state, base }, letters));
        return { shape, note: shape.shown < 1 ? "Only a part of this rod is shown: it bends too often for more." : "" };
      } catch (error) {
        if (!(error instanceof Refused)) throw error;
        return { shape: null, note: error.sentence };
      }
    },
    /* What takes longer than a move of a slider may. */
    facts(shape, crossed) {
      const found = observables(shape),
        bends = found.bends === 1 ? "bend" : "bends",
        told = [`${found.bends} ${bends}, largest push ${inUnit(Math.max(found.push_max, 0), stated(PUSH, data.state.units))}.`];
      return minus([...told, ...warnings(shape, found, data.state.units, crossed)].join(" "));
    },
    reset: () => Object.assign(base, JSON.parse(begun)),
  };
}
