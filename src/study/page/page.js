"use strict";
const errors = [];
addEventListener("error", (e) => errors.push(String(e.message)));
const data = JSON.parse(document.getElementById("data").textContent);
const { report, pictures, references } = data;
const rows = report.rows;
const $ = (id) => document.getElementById(id);
const COLOURS = @COLOURS@;
const COMBINED = "#8b94a1";

// An element with attributes and children; text is always text, never markup.
function element(name, attributes, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) if (value !== false) node.setAttribute(key, value);
  node.append(...children);
  return node;
}
function svg(name, attributes, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes || {})) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const scientific = (x) => (x === 0 ? "0" : x === undefined || x === null ? "–" : x.toExponential(1));
const fixed = (x, n) => (x === undefined || x === null ? "–" : x.toFixed(n));
const times = (x) => (x >= 100 ? x.toFixed(0) : x >= 10 ? x.toFixed(1) : x >= 0.1 ? x.toFixed(3) : x.toPrecision(2));
const percent = (x) => (x === 0 ? "0 %" : x < 0.001 && x > -0.001 ? (100 * x).toPrecision(2) + " %" : (100 * x).toFixed(2) + " %");
const grouped = (n) => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f");
const colour = (row) => (row.name === "default" ? "#111" : row.axis ? COLOURS[row.axis] : COMBINED);
const millis = (s) => (s >= 1 ? s.toFixed(2) + " s" : (1000 * s).toFixed(1) + " ms");

// The two judges: at the default's rays a pixel, and against 16 x 16.
const JUDGES = {
  own: { label: side() === 1 ? "at 1 ray a pixel" : `at ${side()} × ${side()} rays a pixel`, front: "front",
    error: (row) => row.own && (row.own.apart ? row.own.apart.rmse : row.own.rmse),
    note: "Errors against the f64 renderer with the exact choices at the same rays a pixel, ill-conditioned pixels left out." },
  fine: { label: "against 16 × 16 rays a pixel", front: "front_fine",
    error: (row) => row.fine && row.fine.rmse,
    note: "Errors against 16 × 16 rays a pixel: what sampling leaves is part of every error here." },
};
function side() { return rows.length ? parseInt(rows[0].levels.sampling, 10) : 1; }
let judge = rows.some((r) => r.own) ? "own" : "fine";
let chosen = rows.findIndex((r) => r.name !== "default");
if (chosen < 0) chosen = 0;

function drawSubject() {
  const s = report.subject, m = report.machine;
  const shapes = [[s.triangles, "triangle"], [s.spheres, "sphere"], [s.planes, "plane"]]
    .filter(([n]) => n).map(([n, what]) => grouped(n) + " " + what + (n === 1 ? "" : "s"));
  $("subject").textContent = [s.width + " × " + s.height + " pixels", ...shapes, m.cpu,
    report.threads + (report.threads === 1 ? " thread" : " threads"), "Vitrum " + m.vitrum + " for " + m.simd].join(" · ");
}

function drawPlot() {
  const W = 1132, H = 480, L = 62, R = 22, T = 14, B = 46;
  const plot = $("plot");
  plot.replaceChildren();
  plot.setAttribute("viewBox", `0 0 ${W} ${H}`);
  const { error, front, note } = JUDGES[judge];
  $("plot-note").textContent = note + " Whiskers are the intervals of the medians. Down and left is better; the line is the front, which nothing beats in both.";
  const seen = rows.map((row, i) => ({ row, i, t: row.ratio.median, e: error(row) })).filter((p) => p.e !== undefined && p.e !== null && p.t > 0);
  const above = seen.filter((p) => p.e > 0).map((p) => p.e);
  if (!above.length) return;
  const floor = Math.min(...above) / 2;
  for (const p of seen) p.y = Math.max(p.e, floor);
  const range = (values, pad) => {
    const lo = Math.log10(Math.min(...values)), hi = Math.log10(Math.max(...values));
    const more = Math.max((hi - lo) * pad, 0.03);
    return [lo - more, hi + more];
  };
  const [x0, x1] = range(seen.flatMap((p) => [p.t, ...p.row.ratio.interval]), 0.05);
  const [y0, y1] = range(seen.map((p) => p.y), 0.07);
  const X = (t) => L + ((Math.log10(t) - x0) / (x1 - x0)) * (W - L - R);
  const Y = (e) => H - B - ((Math.log10(e) - y0) / (y1 - y0)) * (H - T - B);
  const ticks = (lo, hi, dense) => {
    const out = [];
    for (let d = Math.floor(lo); d <= Math.ceil(hi); d++)
      for (const m of hi - lo < 1.1 && dense ? [1, 1.5, 2, 3, 4, 5, 6, 8] : hi - lo < 2.4 ? [1, 2, 5] : [1]) {
        const v = m * 10 ** d;
        if (Math.log10(v) >= lo && Math.log10(v) <= hi) out.push(v);
      }
    return out;
  };
  for (const t of ticks(x0, x1, true)) {
    plot.append(svg("line", { x1: X(t), x2: X(t), y1: T, y2: H - B, class: "grid" }));
    plot.append(svg("text", { x: X(t), y: H - B + 18, "text-anchor": "middle" }, String(+t.toPrecision(2))));
  }
  for (const e of ticks(y0, y1, false)) {
    plot.append(svg("line", { x1: L, x2: W - R, y1: Y(e), y2: Y(e), class: "grid" }));
    plot.append(svg("text", { x: L - 8, y: Y(e) + 4, "text-anchor": "end" }, e.toExponential(0)));
  }
  if (x0 < 0 && x1 > 0) plot.append(svg("line", { x1: X(1), x2: X(1), y1: T, y2: H - B, class: "one" }));
  plot.append(svg("rect", { x: L, y: T, width: W - L - R, height: H - T - B, class: "frame" }));
  plot.append(svg("text", { x: (L + W - R) / 2, y: H - 8, "text-anchor": "middle" }, "time over the default's"));
  plot.append(svg("text", { transform: `translate(14 ${(T + H - B) / 2}) rotate(-90)`, "text-anchor": "middle" }, "RMSE, in radiance"));
  const onFront = seen.filter((p) => p.row[front]).sort((a, b) => a.t - b.t);
  let path = "";
  onFront.forEach((p, k) => { path += k ? `H${X(p.t)}V${Y(p.y)}` : `M${X(p.t)} ${Y(p.y)}`; });
  if (path) plot.append(svg("path", { d: path, class: "front-line" }));
  const order = [...seen].sort((a, b) => (a.row[front] - b.row[front]) || ((a.row.name === "default") - (b.row.name === "default")));
  for (const p of order) {
    const c = colour(p.row), x = X(p.t), y = Y(p.y);
    const g = svg("g", { class: "point" + (p.i === chosen ? " chosen" : ""), tabindex: 0, "data-row": p.i });
    g.append(svg("title", {}, p.row.name));
    g.append(svg("line", { x1: X(p.row.ratio.interval[0]), x2: X(p.row.ratio.interval[1]), y1: y, y2: y, stroke: c, class: "whisker" }));
    if (p.row.name === "default") g.append(svg("path", { d: `M${x} ${y - 8}l8 8l-8 8l-8 -8z`, fill: c, stroke: "#fff", class: "mark" }));
    else g.append(svg("circle", { cx: x, cy: y, r: p.row[front] ? 6 : 4.2, fill: c, stroke: "#fff", "stroke-width": 1, "fill-opacity": p.row[front] ? 1 : 0.75, class: "mark" }));
    const tip = () => showTip(p, x / W, y / H);
    g.addEventListener("mouseenter", tip);
    g.addEventListener("focus", tip);
    g.addEventListener("mouseleave", () => ($("tip").hidden = true));
    g.addEventListener("blur", () => ($("tip").hidden = true));
    g.addEventListener("click", () => choose(p.i));
    plot.append(g);
  }
  // Names of the front, of the default and of single choices, as far as they find room.
  const taken = seen.map((p) => [X(p.t) - 7, Y(p.y) - 7, X(p.t) + 7, Y(p.y) + 7]);
  const wanted = [...seen].filter((p) => p.row.axis || p.row.name === "default" || p.row[front])
    .sort((a, b) => ((b.row.name === "default") - (a.row.name === "default")) || (b.row[front] - a.row[front]) || (!!b.row.axis - !!a.row.axis));
  for (const p of wanted) {
    const name = p.row.name.length > 34 ? p.row.name.slice(0, 32) + "…" : p.row.name;
    const w = name.length * 6.1 + 4, x = X(p.t), y = Y(p.y);
    const places = [[x + 10, y + 4, "start"], [x - 10, y + 4, "end"], [x + 6, y - 9, "start"], [x + 6, y + 17, "start"], [x - 6, y - 9, "end"], [x - 6, y + 17, "end"]];
    for (const [tx, ty, anchor] of places) {
      const box = [anchor === "start" ? tx : tx - w, ty - 11, anchor === "start" ? tx + w : tx, ty + 3];
      if (box[0] < L + 2 || box[2] > W - R - 2 || box[1] < T || box[3] > H - B) continue;
      if (taken.some((o) => box[0] < o[2] && box[2] > o[0] && box[1] < o[3] && box[3] > o[1])) continue;
      taken.push(box);
      plot.append(svg("text", { x: tx, y: ty, "text-anchor": anchor, class: "label", "pointer-events": "none" }, name));
      break;
    }
  }
}

function showTip(p, fx, fy) {
  const tip = $("tip"), r = p.row;
  const [lo, hi] = r.ratio.interval;
  tip.replaceChildren(element("b", {}, r.name),
    `${times(r.ratio.median)} × the default's time (${times(lo)} to ${times(hi)})${r.same_time && r.name !== "default" ? ": no measurable difference" : ""}`,
    element("br"), `RMSE ${scientific(p.e)}${r[JUDGES[judge].front] ? ", on the front" : ""}`);
  tip.hidden = false;
  tip.style.left = fx > 0.65 ? "" : `calc(${100 * fx}% + 14px)`;
  tip.style.right = fx > 0.65 ? `calc(${100 - 100 * fx}% + 14px)` : "";
  tip.style.top = `calc(${100 * fy}% + 10px)`;
}

function drawLegend() {
  const axes = [...new Set(rows.map((r) => r.axis).filter(Boolean))];
  const items = [["#111", "default"], ...axes.map((a) => [COLOURS[a], a])];
  if (rows.some((r) => !r.axis && r.name !== "default")) items.push([COMBINED, "several choices"]);
  $("legend").replaceChildren(...items.map(([c, name]) => element("span", {}, element("i", { style: `background:${c}` }), name)));
  const buttons = Object.entries(JUDGES).filter(([key, j]) => rows.some((r) => r[key] && j.error(r) !== undefined));
  $("judges").replaceChildren(...buttons.map(([key, j]) => {
    const b = element("button", { type: "button", "aria-pressed": String(key === judge) }, j.label);
    b.addEventListener("click", () => { judge = key; drawLegend(); drawPlot(); });
    return b;
  }));
}

// Tables: columns are [heading, explanation, sort key, cell].
const judged = (r) => r.own || r.fine || {};
const apart = (r) => judged(r).apart || null;
const VARIANTS = [
  ["variant", "what it has else than the default", (r) => r.name, (r) => [dot(r), r.name]],
  ["time", "over the default's, median of the rounds", (r) => r.ratio.median, (r) => times(r.ratio.median)],
  ["interval", "that holds the true median with 95 % confidence (less where there were few runs)", (r) => r.ratio.interval[1] - r.ratio.interval[0],
    (r) => (r.name === "default" ? "" : r.ratio.runs < 3 ? r.ratio.runs + (r.ratio.runs > 1 ? " runs" : " run") : times(r.ratio.interval[0]) + "–" + times(r.ratio.interval[1]))],
  ["", "whether the difference can be measured", (r) => Number(r.same_time), (r) => (r.name === "default" ? "" : r.ratio.runs < 3 ? "too few runs" : r.same_time ? "no measurable difference" : r.ratio.median < 1 ? "faster" : "slower")],
  ["in its walk", "triangles and reciprocals share a walk of one ray at a time: time over that of the watertight test with true division in it, and its interval",
    (r) => (r.walk ? r.walk.median : null), (r) => (r.walk ? times(r.walk.median) + " (" + times(r.walk.interval[0]) + "–" + times(r.walk.interval[1]) + ")" : "–")],
  ["render", "wall time, median", (r) => r.seconds.median, (r) => millis(r.seconds.median)],
  ["RMSE", "against f64 at the same rays a pixel (^: against 16 × 16), ill-conditioned pixels left out", (r) => (apart(r) || judged(r)).rmse,
    (r) => (r.own ? "" : "^ ") + scientific((apart(r) || judged(r)).rmse)],
  ["max", "largest difference of a channel, ill-conditioned pixels left out; ≤ where time ran out before every worse pixel was asked", (r) => (apart(r) || judged(r)).max,
    (r) => (apart(r) && !apart(r).sure ? "≤ " : "") + scientific((apart(r) || judged(r)).max)],
  ["alone", "largest difference from the default's picture: what the choice alone changes", (r) => r.change && r.change.max, (r) => (r.change ? scientific(r.change.max) : "–")],
  ["PSNR", "dB, of the pictures as a screen shows them", (r) => judged(r).psnr, (r) => fixed(judged(r).psnr, 1)],
  ["SSIM", "structural similarity", (r) => judged(r).ssim, (r) => fixed(judged(r).ssim, 4)],
  ["> 1/255", "share of pixels off by more than 1/255", (r) => judged(r).visible, (r) => percent(judged(r).visible || 0)],
  ["ill", "pixels among these whose f64 value moves as much when its rays move by a few f32 ulps (of those asked)",
    (r) => (apart(r) ? apart(r).ill : -1), (r) => (apart(r) ? apart(r).ill + " of " + apart(r).asked : "–")],
  ["rays", "rays traced", (r) => r.rays.total, (r) => grouped(r.rays.total)],
];
const LEDGER = [
  ["variant", "", (r) => r.name, (r) => [dot(r), r.name]],
  ["light", "mean radiance", (r) => r.ledger.light, (r) => fixed(r.ledger.light, 6)],
  ["reference", "mean radiance of the reference", (r) => r.ledger.reference, (r) => fixed(r.ledger.reference, 6)],
  ["error", "light in excess of the reference's", (r) => r.ledger.light / r.ledger.reference, (r) => (r.ledger.reference ? percent(r.ledger.light / r.ledger.reference - 1) : "–")],
  ["gained", "where pixels are too bright", (r) => r.ledger.gained, (r) => scientific(r.ledger.gained)],
  ["lost", "where pixels are too dark", (r) => r.ledger.lost, (r) => scientific(r.ledger.lost)],
  ["cut", "weight of the rays that were ended", (r) => r.ledger.cut, (r) => scientific(r.ledger.cut)],
  ["reflected", "reflected rays", (r) => r.rays.reflected, (r) => grouped(r.rays.reflected)],
  ["transmitted", "transmitted rays", (r) => r.rays.transmitted, (r) => grouped(r.rays.transmitted)],
  ["shadow", "shadow rays", (r) => r.rays.shadow, (r) => grouped(r.rays.shadow)],
  ["deepest", "the deepest level reached", (r) => r.rays.deepest, (r) => r.rays.deepest],
  ["not finite", "contributions left out", (r) => r.ledger.non_finite, (r) => r.ledger.non_finite],
  ["unmatched", "rays that left a medium never entered", (r) => r.ledger.unmatched_exits, (r) => r.ledger.unmatched_exits],
];
function dot(r) {
  return element("span", { class: "dot" + (r.front ? " front" : ""), style: `background:${colour(r)}`, title: r.front ? "on the front" : "" });
}
const sorting = { variants: null, ledger: null };
function drawTable(id, columns) {
  const table = $(id), state = sorting[id];
  const order = rows.map((_, i) => i);
  if (state) {
    const key = columns[state.column][2];
    const value = (i) => { const v = key(rows[i]); return v === undefined || v === null || Number.isNaN(v) ? null : v; };
    order.sort((a, b) => {
      const [x, y] = [value(a), value(b)];
      if (x === null || y === null) return (x === null) - (y === null);
      return state.sign * (typeof x === "string" ? x.localeCompare(y) : x - y);
    });
  }
  table.tHead.replaceChildren(element("tr", {}, ...columns.map(([name, why], c) => {
    const sorted = state && state.column === c ? (state.sign > 0 ? "ascending" : "descending") : false;
    const th = element("th", { title: why, "aria-sort": sorted, tabindex: 0, scope: "col" }, name);
    const sort = () => { sorting[id] = { column: c, sign: state && state.column === c ? -state.sign : 1 }; drawTable(id, columns); };
    th.addEventListener("click", sort);
    th.addEventListener("keydown", (e) => { if (e.key === "Enter") sort(); });
    return th;
  })));
  table.tBodies[0].replaceChildren(...order.map((i) => {
    const row = rows[i];
    const tr = element("tr", { "data-row": i, class: [row.name === "default" && "default", i === chosen && "chosen"].filter(Boolean).join(" ") });
    for (const [name, , , cell] of columns) {
      const content = cell(row);
      tr.append(element("td", name === "" && row.same_time ? { class: "same" } : {}, ...(Array.isArray(content) ? content : [String(content)])));
    }
    tr.addEventListener("click", () => choose(i));
    return tr;
  }));
}

function choose(i) {
  chosen = i;
  for (const tr of document.querySelectorAll("tbody tr")) tr.classList.toggle("chosen", Number(tr.dataset.row) === i);
  for (const g of document.querySelectorAll("#plot .point")) g.classList.toggle("chosen", Number(g.dataset.row) === i);
  $("right").value = "row" + i;
  const row = rows[i];
  const worst = judged(row).worst;
  $("detail").replaceChildren(element("b", {}, row.name), element("br"), element("code", {}, row.command), element("br"),
    `${report.machine.cpu}, ${report.threads} thread${report.threads === 1 ? "" : "s"}, ${report.machine.simd}; built in ${millis(row.build_seconds)}; ${row.ratio.runs} timed run${row.ratio.runs === 1 ? "" : "s"}` +
    (worst ? `; worst pixel: column ${worst[0]}, row ${worst[1]}` : "") +
    (row.settled ? `; ${scientific(row.settled)} of its triangle tests fell to f64` : ""));
  show();
}

// The viewer. Pictures are rows and, where they are there, the references.
function image(key) {
  if (key.startsWith("row")) return (pictures[Number(key.slice(3))] || {}).picture;
  return references[key];
}
function fillViewer() {
  const options = () => [
    ...Object.keys(references).filter((k) => references[k]).map((k) => element("option", { value: k }, k === "own" ? "reference" : "16 × 16 rays a pixel")),
    ...rows.map((r, i) => [r, i]).filter(([, i]) => pictures[i]).map(([r, i]) => element("option", { value: "row" + i }, r.name)),
  ];
  $("left").append(...options());
  $("right").append(...options());
  $("right").value = "row" + chosen;
  for (const id of ["left", "right"]) $(id).addEventListener("change", () => {
    if (id === "right" && $("right").value.startsWith("row")) choose(Number($("right").value.slice(3)));
    else show();
  });
  $("slider").addEventListener("input", slide);
  $("pair").addEventListener("pointermove", (e) => {
    const box = $("pair").getBoundingClientRect();
    $("slider").value = 1000 * (e.clientX - box.left) / box.width;
    slide();
  });
}
function slide() {
  const share = $("slider").value / 10;
  $("over").style.clipPath = `inset(0 ${100 - share}% 0 0)`;
  $("edge").style.left = share + "%";
}
function show() {
  const [left, right] = [$("left").value, $("right").value];
  $("over").src = image(left) || "";
  $("under").src = image(right) || "";
  const label = (id) => $(id).selectedOptions.length ? $(id).selectedOptions[0].textContent : "";
  $("tag-left").textContent = label("left");
  $("tag-right").textContent = label("right");
  const i = right.startsWith("row") ? Number(right.slice(3)) : -1;
  const difference = i >= 0 && pictures[i] ? pictures[i].difference : "";
  $("difference").src = difference || "";
  $("difference").style.visibility = difference ? "" : "hidden";
  $("difference-caption").textContent = i < 0 ? "" : `${rows[i].name}: the largest difference of a channel from ${rows[i].own ? "the reference" : "16 × 16 rays a pixel"}, in decades; black is less than 1e-5.`;
  slide();
}

function drawWords() {
  const items = (id, list, none) => $(id).replaceChildren(...(list.length ? list : [none]).map((text) => element("li", {}, text)));
  items("findings", report.findings, "nothing yet");
  items("left-out", report.left_out, "nothing");
  const own = report.own, fine = report.fine, m = report.machine;
  const made = (v) => Object.entries(v).map(([k, x]) => `${k} ${x}`).join(", ");
  const facts = [
    ["command", element("code", {}, report.command)],
    ["default", rows.length ? made(rows[0].levels) : ""],
    ["reference", own ? `${made(own.variant)}; ${own.seconds.toFixed(1)} s; even that cut a weight of ${scientific(own.cut)} in the mean, ${scientific(own.cut_most)} at most` : "not made"],
    ["sampling", fine ? `judged against ${made(fine.variant)}; ${fine.seconds.toFixed(1)} s` : "not judged"],
    ["times", "wall time of the render without building the hierarchy. Variants take turns with the default; a figure is the median of the ratios within a round, its interval that of order statistics (95 % where there are six runs or more)."],
    ["ill-conditioned", "pixels whose f64 value itself moves by more than 1/255 when their camera rays move by 8 ulps of f32, or by 8 for each level of the path."],
    ["machine", `${m.cpu}, ${m.processors} processors, ${report.threads} threads; Vitrum ${m.vitrum} built for ${m.simd}` + (m.embree ? `; Embree ${m.embree.version}` : "; without Embree")],
    ["state", report.finished ? "finished" : "not finished: the same command goes on"],
  ];
  $("method").replaceChildren(...facts.flatMap(([name, what]) => [element("dt", {}, name), element("dd", {}, what)]));
}

drawSubject();
drawLegend();
drawPlot();
fillViewer();
drawTable("variants", VARIANTS);
drawTable("ledger", LEDGER);
drawWords();
choose(chosen);

// For the test that opens this page in a browser: `#selftest` writes down what it sees.
if (location.hash === "#selftest") {
  const times = () => [...document.querySelectorAll("#variants tbody tr")].map((tr) => rows[Number(tr.dataset.row)].ratio.median);
  const heading = () => document.querySelectorAll("#variants th")[1];
  heading().click();
  const up = times();
  heading().click();
  const down = times();
  const points = document.querySelectorAll("#plot .point").length;
  const named = [...document.querySelectorAll("#plot .point")].every((g) => g.querySelector("title").textContent === rows[Number(g.dataset.row)].name);
  const buttons = document.querySelectorAll("#judges button");
  let fine = null;
  if (buttons.length > 1) { buttons[1].click(); fine = document.querySelectorAll("#plot .point").length; buttons[0].click(); }
  document.querySelector("#plot .point").dispatchEvent(new Event("mouseenter"));
  const tip = $("tip").textContent;
  const line = document.querySelector("#plot .front-line");
  const loaded = [...document.images].filter((i) => i.getAttribute("src")).map((i) => i.decode().then(() => true, () => false));
  Promise.all(loaded).then((all) => {
    document.body.append(element("pre", { id: "selftest" }, JSON.stringify({
      errors, points, fine, named, up, down, tip, line: !!line, images: all, rows: rows.length,
      ledger: document.querySelectorAll("#ledger tbody tr").length, detail: $("detail").textContent,
    })));
  });
}
