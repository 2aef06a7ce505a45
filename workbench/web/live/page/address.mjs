// The state of the page in its address.

import { isState } from "./rod_case.mjs";
import { fromHash, toHash } from "./study_text.mjs";

export function makeAddress(readings) {
  let own = "";

  /* The preset and the state of the address; {} where they are not complete; null where it has none or the page's own. */
  function read() {
    if (location.hash.length < 2 || location.hash === own) return null;
    try {
      const known = fromHash(location.hash.slice(1));
      return isState(known.state, readings) ? known : {};
    } catch {
      return {};
    }
  }

  function show(known) {
    own = `#${toHash(known)}`;
    history.replaceState(null, "", own);
  }

  return { read, show };
}
