// The viewer's data, as `viewer_packing.py` made it: JSON, and series of whole numbers by bytes.
const Unpacking = {
  async read(packed) {
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const plain = new Uint8Array(await new Response(stream).arrayBuffer());
    const end = 4 + new DataView(plain.buffer).getUint32(0, true);
    const data = JSON.parse(new TextDecoder().decode(plain.subarray(4, end)));
    data.series = Unpacking.series(plain.subarray(end), data.lengths);
    return data;
  },
  // Sums second differences up twice, in whole numbers of 32 bits.
  series(planes, lengths) {
    const n = planes.length / 4, values = new Int32Array(n);
    for (let i = 0; i < n; i += 1) {
      values[i] = planes[i] | (planes[n + i] << 8) | (planes[2 * n + i] << 16) | (planes[3 * n + i] << 24);
    }
    let from = 0;
    return lengths.map((length) => {
      const part = values.subarray(from, (from += length));
      let step = 0, value = 0;
      for (let i = 0; i < length; i += 1) {
        step = (step + part[i]) | 0;
        value = (value + step) | 0;
        part[i] = value;
      }
      return part;
    });
  },
};
