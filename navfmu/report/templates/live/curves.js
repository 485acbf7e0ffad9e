// The curves of one run. The chart library is unpacked when the first of them is wanted.
let charts = null;

function library() {
  charts = charts || inflated(document.getElementById("charts").textContent).then((bytes) => {
    document.head.append(made("script", {}, new TextDecoder().decode(bytes)));
    return window.Plotly;
  });
  return charts;
}

const LOOK = { notice: ["#00785a", "dash"], violation: ["#d00000", "dot"] };

async function drawn(number, run, place) {
  const [plotly, about] = await Promise.all([library(), unpacked(document.getElementById(`curves-${number}`).textContent)]);
  if (!place.isConnected) return;
  for (const panel of about.panels) {
    const canvas = made("div", { role: "img", "aria-label": panel.title, class: panel.equal ? "chart map" : "chart" });
    place.append(made("figure", {}, made("figcaption", {}, panel.title), canvas));
    const layout = {
      margin: { l: 64, r: 12, t: 12, b: 44 }, font: { family: "system-ui, sans-serif", size: 12, color: "#1a1a1a" },
      xaxis: { title: { text: panel.x }, zeroline: false, gridcolor: "#e4e4e4" },
      yaxis: { title: { text: panel.y }, zeroline: false, gridcolor: "#e4e4e4" },
      legend: { orientation: "h", y: -0.22, font: { size: 11 } },
      plot_bgcolor: "#fff", paper_bgcolor: "#fff", hovermode: panel.timed ? "x" : "closest", shapes: [], annotations: [],
    };
    if (panel.timed) happened(layout, about, run.events);
    if (panel.equal) {
      layout.yaxis.scaleanchor = "x";
      layout.legend.y = -0.1;
    }
    canvas.style.height = panel.equal ? "640px" : `${250 + layout.margin.t}px`;
    const buttons = [["toImage", "zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "resetScale2d"]]; // none that sends data away
    const options = { responsive: true, displaylogo: false, modeBarButtons: buttons, plotlyServerURL: "about:blank" };
    await plotly.newPlot(canvas, panel.curves.flatMap((curve) => traces(curve, about.columns)), layout, options);
  }
}

function traces(curve, columns) {
  const x = columns[curve.x], y = columns[curve.y];
  const line = { name: curve.name, x, y, mode: "lines", line: { color: curve.colour, width: 1.4 }, connectgaps: false };
  if (curve.look === "steps") line.line.shape = "hv";
  if (curve.look === "outline") Object.assign(line, { line: { color: curve.colour, width: 1.2, dash: x.length === 2 ? "dash" : "solid" }, hoverinfo: "name" });
  if (curve.look === "marks") {
    const marker = { symbol: curve.symbol, color: curve.colour, size: 10, line: { width: 2, color: curve.colour } };
    return [{ name: curve.name, x, y, mode: "markers", marker, text: curve.texts, hovertemplate: "%{text}<extra></extra>" }];
  }
  if (curve.look === "band") {
    const none = { mode: "lines", line: { width: 0.5, color: curve.colour }, legendgroup: curve.name, connectgaps: false };
    const fill = { fill: "tonexty", fillcolor: `${curve.colour}33` };
    return [
      { ...none, name: curve.name, x, y: y.map((v) => (v === null ? null : -v)), showlegend: false, hoverinfo: "skip" },
      { ...none, ...fill, name: curve.name, x, y },
    ];
  }
  return [line];
}

// Faults are shaded, and named above; what was noticed and violated has a line.
function happened(layout, about, events) {
  const named = new Map();
  const above = (text, x, color) => {
    const key = `${text} ${color}`;
    if (named.has(key)) return;
    named.set(key, x);
    const late = x > 0.6 * about.end;
    layout.annotations.push({
      text, x, xref: "x", y: 1, yref: "paper", yanchor: "bottom", yshift: 14 * (named.size - 1), showarrow: false,
      xanchor: late ? "right" : "left", font: { size: 10.5, color },
    });
  };
  for (const [name, start, end] of about.windows) {
    if (start > about.end) continue;
    layout.shapes.push({
      type: "rect", xref: "x", yref: "paper", x0: start, x1: end, y0: 0, y1: 1, fillcolor: "#777", opacity: 0.12,
      line: { width: 0 }, layer: "below",
    });
    above(`fault ${name}`, start, "#555");
  }
  for (const [kind, name, time] of events) {
    if (!LOOK[kind]) continue;
    const [color, dash] = LOOK[kind];
    layout.shapes.push({ type: "line", xref: "x", yref: "paper", x0: time, x1: time, y0: 0, y1: 1, line: { color, dash, width: 1.2 } });
    above(kind === "notice" ? `noticed: ${name}` : `${name} first violated`, time, color);
  }
  layout.margin.t = 12 + 14 * named.size;
  layout.xaxis.range = [0, about.end];
}
