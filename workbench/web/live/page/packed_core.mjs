// The compiled core, as a file carries it: base64 of its compressed bytes.

/* Its functions. text: `live_document.core_text`. */
export async function coreOf(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0)),
    plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return RodCore.load(await new Response(plain).arrayBuffer());
}
