// Reads what the page carries: text in base64, deflated; inside a head of JSON and a binary body.

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).arrayBuffer();
}

/**
 * Head and body of the element with this id; null where it holds nothing.
 *
 * @param format the one that is read
 */
export async function unpack(id, format) {
  const text = document.getElementById(id)?.textContent.trim();
  if (!text) return null;
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const buffer = await inflate(bytes);
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  if (head.format !== format) {
    throw new Error(`The data has format ${head.format}, this page reads format ${format}. `
      + "Make page and data with the same urdf2fmu.");
  }
  return { head, body: new Uint8Array(buffer, 4 + length) };
}

/**
 * Columns of a run by name. A column is `low + step · n`; n is written as first or second
 * differences, with the sign in the lowest bit, in planes of bytes. Rows without a value are NaN.
 */
export function columns({ head, body }) {
  const { rows } = head;
  const found = new Map();
  let at = 0;
  for (const { name, low, step, planes, order, gaps } of head.columns) {
    const values = name === "time" ? new Float64Array(rows) : new Float32Array(rows);
    const zigzag = new Uint32Array(rows);
    for (let plane = 0; plane < planes; plane++, at += rows) {
      for (let i = 0; i < rows; i++) zigzag[i] |= body[at + i] << (8 * plane);
    }
    let n = 0;
    let slope = 0;
    for (let i = 0; i < rows; i++) {
      const difference = (zigzag[i] >>> 1) ^ -(zigzag[i] & 1);
      if (order === 2) {
        slope += difference;
        n += slope;
      } else {
        n += difference;
      }
      values[i] = low + n * step;
    }
    for (const [first, count] of gaps ?? []) values.fill(NaN, first, first + count);
    found.set(name, values);
  }
  return found;
}
