// Bytes that a file carries as base64, and the compiled core, whose bytes are compressed.

export const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/* The functions of the core. text: `live_document.core_text`. */
export async function coreOf(text) {
  const plain = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return RodCore.load(await new Response(plain).arrayBuffer());
}
