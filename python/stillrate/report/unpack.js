// Numbers out of text, as packing.py put them in; and what to show when a page fails.
"use strict";

function bytesOf(text) {
  const letters = atob(text), found = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) found[i] = letters.charCodeAt(i);
  return found;
}

// Numbers as whole multiples of a step: differences, zigzag, four planes of bytes, deflated.
async function unpack(packed) {
  if (!packed) return null;
  const stream = new Blob([bytesOf(packed.data)]).stream().pipeThrough(new DecompressionStream("deflate"));
  const b = new Uint8Array(await new Response(stream).arrayBuffer()), n = packed.count;
  const found = packed.wide ? new Float64Array(n) : new Float32Array(n);
  let whole = 0;
  for (let i = 0; i < n; i++) {
    const z = (b[i] | b[n + i] << 8 | b[2 * n + i] << 16 | b[3 * n + i] << 24) >>> 0;
    whole += (z >>> 1) ^ -(z & 1);
    found[i] = packed.offset + whole * packed.step;
  }
  for (const [from, to] of packed.missing) found.fill(NaN, from, to);
  packed.data = "";
  return found;
}

function failed(error) {
  document.getElementById("failed").textContent = "This page could not be shown: " + error;
  throw error;
}
