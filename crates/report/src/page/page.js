"use strict";
// Draws the runs whose data stand in this page. Spectra are held for ρ ≥ 0: S(−ρ, −ν) = S*(ρ, ν).
const read = (element) => JSON.parse(element.textContent);
const all = [...document.querySelectorAll("script.run-data")].map((element) => ({ ...read(element), folder: element.dataset.folder }));
/** Those whose data can be drawn. */
const runs = [];
const colors = read(document.getElementById("colors"));
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const floats = (text) => new Float32Array(bytes(text).buffer);
const sequential = bytes(colors.sequential);
const diverging = bytes(colors.diverging);
const MISSING = [158, 158, 158];
/** Differences beyond this many σ keep the last color. */
const MOST_SIGMA = 4;

const make = (name, content, parent, attributes = {}) => {
  const element = document.createElement(name);
  if (content !== null) element.textContent = content;
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
};
const digits = (x, n = 4) => (x === null || x === undefined ? "–" : Number(x.toPrecision(n)).toString());
const color = (table, t) => {
  const i = 3 * Math.round(255 * Math.min(1, Math.max(0, t)));
  return [table[i], table[i + 1], table[i + 2]];
};

/** Everything that is drawn again when the controls change. */
const pictures = [];
const state = { floor: -50, azimuth: "", at: {} };

/** A grid of values with its axes: [x, y] in row-major order, both ascending. */
class Grid {
  constructor(axes, values) {
    [this.x, this.y] = axes;
    this.values = values;
    if (values.length !== this.columns() * this.y.count) throw new RangeError("a picture has another size than its axes");
  }
  columns() {
    return this.x.count;
  }
  /** The value at cell (i, j). */
  value(i, j) {
    return this.values[i * this.y.count + j];
  }
}

/** One that holds ρ ≥ 0 alone. */
class HalfGrid extends Grid {
  columns() {
    return (this.x.count + 1) / 2;
  }
  value(i, j) {
    const half = (this.x.count - 1) / 2;
    const [a, b] = i >= half ? [i - half, j] : [half - i, this.y.count - 1 - j];
    return this.values[a * this.y.count + b];
  }
}

const place = (axis, i) => axis.min + ((i + 0.5) * (axis.max - axis.min)) / axis.count;
const cell = (axis, value) =>
  Math.min(axis.count - 1, Math.max(0, Math.floor(((value - axis.min) / (axis.max - axis.min)) * axis.count)));

/** Round numbers along an axis, about as many as asked for. */
const ticks = (min, max, count) => {
  const least = (max - min) / count;
  const decade = 10 ** Math.floor(Math.log10(least));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((n) => n >= least * (1 - 1e-9));
  const first = Math.ceil(min / step - 1e-9);
  const last = Math.floor(max / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => (first + i) * step);
};
const signed = (text) => text.replace("-", "−");
/** Numbers beside a picture or a color bar, at their shares of its length. */
const scale = (parent, side, [min, max], count, show = (x) => digits(x, 3)) => {
  const box = make("div", null, parent, { class: `scale ${side}`, "aria-hidden": "true" });
  for (const value of ticks(min, max, count)) {
    const share = `${(100 * (value - min)) / (max - min)}%`;
    make("span", signed(show(value)), box, { style: side === "below" ? `left: ${share}` : `bottom: ${share}` });
  }
  return box;
};
const label = (axis) => (axis.unit ? `${axis.name} (${axis.unit})` : axis.name);
const gradient = (table) => {
  const stops = Array.from({ length: 33 }, (_, i) => `rgb(${color(table, i / 32).join()})`);
  return `linear-gradient(to top, ${stops.join()})`;
};

/** A canvas with a mark; `kind` links it with others, `grids()` are what it stands beside. */
class Picture {
  constructor(kind, which, panel, parent, caption) {
    Object.assign(this, { kind, which, panel });
    const figure = make("figure", null, parent);
    make("figcaption", caption, figure);
    const plot = make("div", null, figure, { class: "plot" });
    const { x, y } = this.grid();
    make("div", label(y), plot, { class: "name upwards" });
    scale(plot, "left", [y.min, y.max], 5);
    this.canvas = make("canvas", null, plot, { tabindex: "0", role: "img", "aria-label": `${panel.name}: ${caption}` });
    make("div", null, plot, { class: "bar", style: `background: ${gradient(which === "z" ? diverging : sequential)}` });
    this.levels = make("div", null, plot, { class: "levels" });
    scale(plot, "below", [x.min, x.max], 4);
    make("div", label(x), plot, { class: "name level" });
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerdown", (event) => this.point(event));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    pictures.push(this);
  }
  grid() {
    return this.panel.grids()[this.which];
  }
  point(event) {
    const box = this.canvas.getBoundingClientRect();
    const { x, y } = this.grid();
    const share = [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
    mark(this.kind, [x.min + share[0] * (x.max - x.min), y.min + share[1] * (y.max - y.min)]);
  }
  key(event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    event.preventDefault();
    const { x, y } = this.grid();
    const at = state.at[this.kind] || [0, 0];
    const moved = [cell(x, at[0]) + step[0], cell(y, at[1]) + step[1]];
    mark(this.kind, [place(x, Math.min(x.count - 1, Math.max(0, moved[0]))), place(y, Math.min(y.count - 1, Math.max(0, moved[1])))]);
  }
  shade(value) {
    if (Number.isNaN(value)) return MISSING;
    if (this.which === "z") return color(diverging, 0.5 + (0.5 * value) / MOST_SIGMA);
    const peak = this.panel.peak();
    if (this.kind === "field") return color(sequential, peak > 0 ? value / peak : 0);
    const level = value > 0 && peak > 0 ? 10 * Math.log10(value / peak) : -Infinity;
    return color(sequential, 1 - level / state.floor);
  }
  /** The numbers beside the color bar. */
  bar() {
    const range = () => {
      if (this.which === "z") return [[-MOST_SIGMA, MOST_SIGMA], "σ"];
      if (this.kind === "spectrum") return [[state.floor, 0], "dB of the peak"];
      return [[0, this.panel.peak() || 1], this.panel.plane.field_unit];
    };
    const [ends, unit] = range();
    const key = JSON.stringify([ends, unit]);
    if (key === this.levelsKey) return;
    this.levelsKey = key;
    this.levels.replaceChildren();
    scale(this.levels, "right", ends, 5);
    make("div", unit, this.levels, { class: "name upwards" });
  }
  draw() {
    this.bar();
    const grid = this.grid();
    const [w, h] = [grid.x.count, grid.y.count];
    if (this.canvas.width !== w || this.canvas.height !== h) Object.assign(this.canvas, { width: w, height: h });
    const context = this.canvas.getContext("2d");
    const image = context.createImageData(w, h);
    for (let i = 0; i < w; i++) {
      for (let j = 0; j < h; j++) {
        image.data.set([...this.shade(grid.value(i, j)), 255], 4 * ((h - 1 - j) * w + i));
      }
    }
    context.putImageData(image, 0, 0);
    const at = state.at[this.kind];
    if (!at) return;
    const [i, j] = [cell(grid.x, at[0]), h - 1 - cell(grid.y, at[1])];
    context.fillStyle = "rgba(127, 224, 255, 0.55)";
    context.fillRect(i, 0, 1, h);
    context.fillRect(0, j, w, 1);
  }
}

/** Measured, predicted and difference of a plane. */
class Panel {
  constructor(plane, kind, parent, captions) {
    Object.assign(this, { plane, kind, name: plane.report.name });
    const box = make("div", null, parent, { class: "pictures" });
    for (const [which, caption] of captions) new Picture(kind, which, this, box, caption);
    this.line = make("div", "", parent, { class: "value", "aria-live": "polite" });
    panels.push(this);
  }
  grids() {
    if (this.kind === "field") return this.plane.field;
    const slices = this.plane.slices;
    return state.azimuth !== "" && slices ? slices[Math.min(slices.length - 1, Number(state.azimuth))] : this.plane.radial;
  }
  peak() {
    const { predicted, measured } = this.grids();
    const of = (grid) => grid.values.reduce((a, b) => (b > a ? b : a), 0);
    return of(predicted) || of(measured);
  }
  tell() {
    const at = state.at[this.kind];
    if (!at) return;
    const grids = this.grids();
    const { x, y } = grids.measured;
    const [i, j] = [cell(x, at[0]), cell(y, at[1])];
    const [m, p, z] = ["measured", "predicted", "z"].map((which) => grids[which].value(i, j));
    const peak = this.peak();
    const shown = (value) =>
      this.kind === "field" ? digits(value) : value > 0 && peak > 0 ? (10 * Math.log10(value / peak)).toFixed(2) + " dB" : "below 0";
    this.line.textContent =
      `${x.name} = ${digits(place(x, i))} ${x.unit}, ${y.name} = ${digits(place(y, j))} ${y.unit}: ` +
      `measured ${shown(m)}, predicted ${shown(p)}, difference ${Number.isNaN(z) ? "–" : z.toFixed(2) + " σ"}`;
  }
}
const panels = [];

const mark = (kind, at) => {
  state.at[kind] = at;
  refresh(kind);
};
const refresh = (kind) => {
  for (const picture of pictures) if (!kind || picture.kind === kind) picture.draw();
  for (const panel of panels) if (!kind || panel.kind === kind) panel.tell();
};

const decoded = (plane) => {
  const { x, u, rho, nu } = plane.axes;
  const grids = (Kind, axes, of) => ({
    measured: new Kind(axes, floats(of.measured)),
    predicted: new Kind(axes, floats(of.predicted)),
    z: new Kind(axes, floats(of.z)),
  });
  plane.field = grids(Grid, [x, u], plane.field);
  plane.radial = grids(HalfGrid, [rho, nu], plane.radial);
  plane.slices = plane.slices && plane.slices.map((slice) => grids(HalfGrid, [rho, nu], slice));
};

const table = (parent, [header, ...rows]) => {
  const table = make("table", null, parent);
  const head = make("tr", null, make("thead", null, table));
  for (const name of header) make("th", name, head, { scope: "col" });
  const body = make("tbody", null, table);
  for (const row of rows) {
    const line = make("tr", null, body);
    for (const cell of row) make("td", cell, line);
  }
};

const showPlane = (plane, parent) => {
  decoded(plane);
  const report = plane.report;
  const section = make("section", null, parent);
  make("h3", report.name.replaceAll("_", " "), section);
  make("p", plane.words, section, { class: `verdict ${report.verdict}` });
  for (const said of [report.undecided, plane.on_chain]) if (said) make("p", said, section);
  const captions = (what) => [
    ["measured", `${what}, measured`],
    ["predicted", "predicted"],
    ["z", `difference in σ, ±${MOST_SIGMA}`],
  ];
  new Panel(plane, "spectrum", section, captions("spectrum"));
  new Panel(plane, "field", section, captions(`light field in (${plane.axes.x.name}, ${plane.axes.u.name})`));
  const chain = make("details", null, section);
  make("summary", `prediction: ${report.class.replace("_", " ")}`, chain);
  make("pre", report.chain.join("\n"), chain);
  for (const warning of report.warnings) make("p", `warning: ${warning}`, section);
};

/** The fields of a scene by their paths. */
const fields = (value, path = "") => {
  if (value === null || typeof value !== "object") return [[path, JSON.stringify(value)]];
  return Object.entries(value).flatMap(([key, inner]) => fields(inner, path ? `${path}.${key}` : key));
};
/** What distinguishes a run from the others of a scene of the same name. */
const differences = (run) => {
  const alike = all.filter((other) => other.scene === run.scene).map((other) => new Map(fields(other.scene_file)));
  const own = new Map(fields(run.scene_file));
  const names = [...new Set(alike.flatMap((other) => [...other.keys()]))];
  const differing = names.filter((name) => alike.some((other) => other.get(name) !== own.get(name)));
  // As in messages: blockers[0].fill, without the variants on the way.
  const path = (name) => name.replace(/\.[A-Z]\w*(?=\.)/g, "").replace(/\.(\d+)(?=\.|$)/g, "[$1]");
  const shown = differing.slice(0, 6).map((name) => `${path(name)} = ${own.get(name) ?? "–"}`);
  return [...shown, ...(differing.length > 6 ? [`${differing.length - 6} more fields`] : [])].join(", ");
};

const showRun = (run, article) => {
  const differing = differences(run);
  make("h2", differing ? `${run.scene}: ${differing}` : run.scene, article);
  const source = run.provenance.split("\n");
  const lines = [run.folder, source[0], source.at(-1)].filter((line) => line);
  make("p", lines.join(" · "), article, { class: "source" });
  make("p", run.words, article, { class: `verdict ${run.verdict}` });
  // As an image, an SVG runs no script and asks for nothing from outside, whoever made it.
  const src = `data:image/svg+xml,${encodeURIComponent(run.path)}`;
  make("img", null, make("div", null, article, { class: "path" }), { src, alt: "light fields and spectra along the path" });
  if (run.explorer !== null) {
    // Beside its results; a file has no other address than its own. The address begins with ./, because a folder's
    // name may look like another kind of address.
    const folder = run.folder.split("/").map(encodeURIComponent).join("/");
    const href = `./${folder}explorer.html#${encodeURI(run.explorer)}`;
    make("a", "this scene in the explorer, to be dragged", make("p", null, article), { href, class: "explorer" });
  }
  const [planes, parameters] = run.tables;
  table(article, planes);
  for (const plane of run.planes) showPlane(plane, article);
  make("h3", "Parameters, measured from the spectra alone", article);
  table(article, parameters);
  make("h3", "Where it comes from", article);
  make("pre", run.provenance, article);
  const scene = make("details", null, article);
  make("summary", "the scene as it was run", scene);
  make("pre", JSON.stringify(run.scene_file, null, 2), scene);
};

/** A run that cannot be drawn does not hide the others. */
const tryRun = (run) => {
  const article = make("article", null, document.getElementById("runs"), { class: "run" });
  const before = [pictures.length, panels.length];
  try {
    showRun(run, article);
    pictures.slice(before[0]).forEach((picture) => picture.draw());
    runs.push(run);
  } catch (error) {
    [pictures.length, panels.length] = before;
    article.replaceChildren();
    make("h2", `${run.folder}: the data of this run cannot be shown`, article);
    make("p", String(error), article, { class: "verdict fail" });
  }
};

all.forEach(tryRun);
const azimuth = document.getElementById("azimuth");
const most = runs.flatMap((run) => run.planes.map((plane) => plane.azimuths)).sort((a, b) => b.length - a.length)[0] || [];
if (runs.some((run) => run.planes.some((plane) => plane.slices))) {
  most.forEach((angle, k) => make("option", `azimuth ${digits((angle * 180) / Math.PI, 4)}°`, azimuth, { value: String(k) }));
} else {
  azimuth.title = "the slices of each azimuth are too large for this page: they are in slices.npz";
}
azimuth.addEventListener("input", () => {
  state.azimuth = azimuth.value;
  refresh();
});
const level = document.getElementById("floor");
level.addEventListener("input", () => {
  state.floor = Number(level.value);
  document.getElementById("level").textContent = `${level.value.replace("-", "−")} dB`;
  refresh();
});
refresh();
document.documentElement.dataset.drawn = String(pictures.length);
