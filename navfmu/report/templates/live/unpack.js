// What the page holds deflated: the chart library, and the curves of single runs.
async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// One line of JSON, then columns: of each all low bytes of the differences of 16 bit numbers, then all high bytes.
async function unpacked(text) {
  const bytes = await inflated(text);
  const end = bytes.indexOf(10);
  const about = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
  let place = end + 1;
  about.columns = about.columns.map(([length, offset, step]) => {
    const values = new Array(length);
    for (let i = 0, number = 0; i < length; i++) {
      number = (number + bytes[place + i] + 256 * bytes[place + length + i]) & 0xffff;
      const signed = number > 32767 ? number - 65536 : number;
      values[i] = signed === -32768 ? null : offset + step * signed;
    }
    place += 2 * length;
    return values;
  });
  return about;
}

function made(tag, attributes, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}
