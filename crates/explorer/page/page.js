/** The colors of the report, from black to light. */
const COLORS = "AAAEAAAFAQAGAQEIAQEKAgEMAgIOAwIQAwISBAMUBQMWBgQZBwQbCAUdCQYfCgYhCwckDAcmDQgoDggrDwktEQkvEgoyEwo0FQs2Fgs5Fws7GQw+GgxAHAxDHQxFHwxHIQxKIgxMJAxOJgtRJwtTKQtVKwtXLQpZLwpaMApcMgpdNAlfNglgNwliOQljOwlkPAllPglmQAlnQgpnQwpoRQppRwppSAtqSgtqSwxrTQxrTw1sUA1sUg5sUw5tVQ9tVw9tWBBuWhFuWxFuXRJuXxJuYBNuYhRuYxRuZRVuZxVuaBZuahduaxdubRhubxhucBluchlucxpudRttdhtteBxtehxtex1tfR1sfh5sgB9sgh9rgyBrhSBrhiFqiCFqiiJpiyJpjSNpjiRokCRokSVnkyVnlSZmliZmmCdlmShlmyhknSljniljoCpioStioythpCxgpi1fpy1fqS5eqy9drC9drjBcrzFbsTFasjJZtDNZtTRYtzRXuDVWujZVuzdUvThTvjlSwDlRwTpQwjtPxDxOxT1Nxz5MyD9LyUBKy0FJzEJIzUNHz0RG0EVF0UZE00dD1EhC1UlA1ks/2Ew+2U092k4820873FE53lI431M34FQ24VY14lc041gy5Fox5Vsw5l0v514u6F8s6WEr6mIq6mQp62Un7Gcm7Wgl7mok7mwi720h8G8g8HEe8XId8nQc8nYa83cZ9HkY9HsW9XwV9X4U9oAT9oIR94MQ94UP+IcN+IkM+IoL+YwK+Y4J+ZAI+pIH+pQG+pUG+5cG+5kG+5sG+50G+58H/KEI/KMJ/KQK/KYL/KgN/KoP/KwQ/K4S/LAU/LIW+7QY+7Ya+7gc+7of+7wh+r4j+sAl+sIo+sQq+cUs+ccv+cky+Ms0+M03988699E99tNA9tVD9ddG9dlJ9NtM9N1P9N9S8+FW8+NZ8uRd8uZh8uhl8epp8ett8e1x8e918fB58fJ98vOB8vWG8/aK9PeO9fmS9vqW9/uZ+fyd+v2g/P+k";
/** Which numbers change what is seen at each plane; at the others all do. */
const VIEWED = ["window_x", "window_u", "rho_max", "rho_step", "nu_max", "nu_step", "glossy"];
const BY_LIGHT = ["width", ...VIEWED];
const DEPENDS = { light: BY_LIGHT, before_blockers: ["at", ...BY_LIGHT] };
const TITLES = {
  light: ["light", "a product of a box and the window"],
  before_blockers: ["before blockers", "travel: a shear along x, and along ν"],
  after_blockers: ["after blockers", "a product: the spectrum is convolved"],
  receiver: ["at the receiver", "travel: sheared with its replicas"],
  irradiance: ["times the cosine", "a product: blurred along ν"],
  leaving: ["leaving", "all slopes added up: ν = 0 is left"],
  curvature: ["in local normals", "curvature: a shear along ρ"],
  reflection: ["after the lobe", "convolved over slopes: a low-pass in ν"],
};

const byId = (id) => document.getElementById(id);
const make = (name, parent, attributes = {}, text = null) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== null) element.textContent = text;
  if (parent) parent.append(element);
  return element;
};
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
const digits = (value, n = 3) => Number(value.toPrecision(n)).toString().replace("-", "−");
const palette = (() => {
  const colors = bytes(COLORS);
  // Little-endian RGBA.
  return Uint32Array.from({ length: 256 }, (_, i) => (0xff000000 | (colors[3 * i + 2] << 16) | (colors[3 * i + 1] << 8) | colors[3 * i]) >>> 0);
})();
const shade = (share) => palette[Math.round(255 * Math.min(1, Math.max(0, share)))];

let explorer = null;
let background = null;
let world = null;
const state = { floor: -40, planes: new Map(), order: [], pending: false, busy: false, wanted: null, step: 0, at: null };
/** Milliseconds of work in each frame, for those who measure it. */
const frames = [];
/** When a slow plane was drawn. */
const slowFrames = [];

const get = (name) => explorer.get(name);
const set = (name, value) => {
  explorer.set(name, value);
  request();
};
const request = () => {
  if (state.pending) return;
  state.pending = true;
  requestAnimationFrame(frame);
};

/** What the numbers at a place of a picture are. */
const tell = (picture, share) => {
  if (state.at && state.at.picture !== picture) state.at.picture.mark.style.display = "none";
  state.at = { picture, share };
  const { plane, kind, mark } = picture;
  mark.style.display = "";
  mark.setAttribute("cx", String(share[0]));
  mark.setAttribute("cy", String(-share[1]));
  const [cells, halfX, halfU, rho, rhoStep, nu, nuStep] = plane.axes;
  const cell = (n, value) => Math.min(n - 1, Math.max(0, Math.floor(((value + 1) / 2) * n)));
  const line = byId("pointed");
  const title = TITLES[plane.name][0];
  if (kind === "field") {
    const [i, j] = share.map((value) => cell(cells, value));
    const place = [(2 * (i + 0.5)) / cells - 1, (2 * (j + 0.5)) / cells - 1];
    line.textContent = `${title}: x = ${digits(place[0] * halfX)} m, u = ${digits(place[1] * halfU)}: ${plane.field[i * cells + j].toPrecision(6)} W m⁻² sr⁻¹ m`;
    return;
  }
  const [i, j] = [cell(2 * rho + 1, share[0]) - rho, cell(2 * nu + 1, share[1]) - nu];
  const index = 2 * (Math.abs(i) * (2 * nu + 1) + (i < 0 ? nu - j : nu + j));
  const [re, im] = [plane.spectrum[index], plane.spectrum[index + 1] * (i < 0 ? -1 : 1)];
  const level = (10 * Math.log10((re * re + im * im) / plane.peak)).toFixed(2).replace("-", "−");
  line.textContent = `${title}: ρ = ${digits(i * rhoStep)} 1/m, ν = ${digits(j * nuStep)}: ${re.toExponential(6)} ${im < 0 ? "−" : "+"} ${Math.abs(im).toExponential(6)} i, ${level} dB`;
};

const keyOf = (name, all) => {
  const names = DEPENDS[name];
  return names ? names.map((n) => get(n)).join() : all;
};

/** Makes the planes of the scene that are not there yet, and hides those that are not its own. */
const arrange = () => {
  const names = explorer.planes().split("\n");
  state.order = names.map((name, index) => {
    const isSlow = name.startsWith("*");
    const plain = name.replace("*", "");
    if (!state.planes.has(plain)) state.planes.set(plain, new Plane(plain));
    return { plane: state.planes.get(plain), index, isSlow };
  });
  const shown = new Set(state.order.map(({ plane }) => plane));
  for (const plane of state.planes.values()) plane.box.hidden = !shown.has(plane);
  for (const { plane } of state.order) {
    byId("planes").append(plane.box);
    plane.head();
  }
  state.glossy = get("glossy");
};

const frame = () => {
  state.pending = false;
  const start = performance.now();
  if (state.glossy !== get("glossy")) arrange();
  const all = explorer.fragment();
  for (const { plane, index, isSlow } of state.order) {
    const key = keyOf(plane.name, all);
    if (isSlow || plane.key === key) continue;
    plane.key = key;
    plane.first(index);
  }
  askForSlow(true);
  world.draw();
  sliders();
  facts();
  frames.push(performance.now() - start);
  clearTimeout(state.settling);
  state.settling = setTimeout(settle, 150);
};

/** Coarse while anything moves, then fine. */
const askForSlow = (isCoarse) => {
  if (!background) return;
  if (state.busy) {
    state.wanted = { isCoarse };
    return;
  }
  const fragment = explorer.fragment();
  const isOld = ({ plane, isSlow }) => isSlow && plane.key !== fragment && !(isCoarse && plane.coarse === fragment);
  const planes = state.order.filter(isOld);
  if (planes.length === 0) return;
  state.busy = true;
  background.postMessage({ fragment, isCoarse, planes: planes.map(({ plane, index }) => ({ name: plane.name, index })) });
};

/** Rays off the glossy receiver, a second or so for each plane. */
const follow = () => {
  if (get("glossy") === 0 || state.pending) return;
  const fragment = explorer.fragment();
  const planes = state.order.slice(4);
  for (const { plane } of planes) plane.words.textContent = "following rays …";
  const list = planes.map(({ plane, index }) => ({ name: plane.name, index }));
  if (background) background.postMessage({ fragment, follow: list });
  else for (const { name, index } of list) answered({ data: { name, key: fragment, followed: explorer.follow(index) } });
};

const answered = ({ data }) => {
  if (data.followed) {
    const plane = state.planes.get(data.name);
    if (data.key === explorer.fragment() && !state.pending && !plane.followed) plane.follow(data.followed);
    return;
  }
  if (data.done) {
    state.busy = false;
    const wanted = state.wanted;
    state.wanted = null;
    if (wanted) askForSlow(wanted.isCoarse);
    return;
  }
  const found = state.order.find(({ plane, isSlow }) => isSlow && plane.name === data.name);
  if (!found) return;
  found.plane[data.isCoarse ? "coarse" : "key"] = data.key;
  found.plane.show(data);
  slowFrames.push(performance.now());
};

/** Once nothing moves: what costs time and need not follow each frame. */
const settle = () => {
  askForSlow(false);
  const fragment = explorer.fragment();
  for (const { plane, index, isSlow } of state.order) {
    if (background || !isSlow || plane.key === fragment) continue;
    plane.key = fragment;
    plane.first(index);
  }
  byId("scene").textContent = explorer.scene();
  history.replaceState(null, "", fragment ? `#${fragment}` : location.href.split("#")[0]);
};

const facts = () => {
  const [travel, at, pitch] = [get("travel"), get("at"), get("pitch")];
  const all = [`the light's line at the receiver is ν = −${digits(travel)} ρ`];
  if (get("fill") > 0) all.push(`replicas at multiples of ${digits(1 / pitch)} cycles/m, on ν = −${digits(travel - at)} ρ`);
  if (get("glossy") > 0) {
    const [cutoff, even, edge] = explorer.criterion();
    all.push(`the lobe lets ${digits(cutoff)} cycles/rad pass (99 % of its energy); an eye 1 m off sees at most ${digits(even)} under an even sky (Eq. 20), ${digits(edge)} behind an edge of the blockers (Eq. 21)`);
  }
  byId("facts").textContent = `${all.join("; ")}.`;
};

const GROUPS = { width: "light", position: "light", travel: "light", at: "blockers", pitch: "blockers", fill: "blockers", count: "blockers", curvature: "receiver", exponent: "receiver" };
const inputs = [];
const toSlider = (row, value) => (row.step > 0 ? value : Math.log10(value));
const buildSliders = () => {
  for (const row of JSON.parse(wasm_bindgen.Explorer.table())) {
    if (!row.label) continue;
    const group = document.querySelector(`[data-group="${GROUPS[row.name]}"]`);
    const label = make("label", group, { class: "ranged" }, row.label);
    const range = { min: toSlider(row, row.min), max: toSlider(row, row.max), step: row.step || 0.01 };
    const input = make("input", label, { type: "range", id: row.name, ...range });
    const output = make("output", label);
    input.addEventListener("input", () => set(row.name, row.step > 0 ? Number(input.value) : Math.round(10 ** Number(input.value))));
    inputs.push({ row, label, input, output });
  }
  byId("follow").parentElement.append(byId("follow"));
  for (const radio of document.querySelectorAll('[name="glossy"]')) radio.addEventListener("input", () => set("glossy", Number(radio.value)));
};
const sliders = () => {
  for (const { row, label, input, output } of inputs) {
    const value = get(row.name);
    input.value = String(toSlider(row, value));
    output.textContent = `${digits(value)} ${row.unit}`;
    label.hidden = (row.name === "curvature" || row.name === "exponent") && get("glossy") === 0;
  }
  byId("follow").hidden = get("glossy") === 0;
  for (const radio of document.querySelectorAll('[name="glossy"]')) radio.checked = Number(radio.value) === get("glossy");
};

/** Shows a step of the tour; `sets` whether the scene becomes the step's. */
const step = (index, sets) => {
  state.step = Math.min(STEPS.length - 1, Math.max(0, index));
  const { title, words, planes, set: values } = STEPS[state.step];
  byId("title").textContent = title;
  byId("words").textContent = words;
  byId("step").textContent = `${state.step + 1} of ${STEPS.length}`;
  byId("previous").disabled = state.step === 0;
  byId("next").disabled = state.step === STEPS.length - 1;
  if (sets) for (const [name, value] of Object.entries(values)) explorer.set(name, value);
  arrange();
  for (const plane of state.planes.values()) plane.box.classList.toggle("told", planes.includes(plane.name));
  request();
};

const listen = () => {
  byId("previous").addEventListener("click", () => step(state.step - 1, true));
  byId("next").addEventListener("click", () => step(state.step + 1, true));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "n") step(state.step + 1, true);
    if (event.key === "r") follow();
    if (event.key === "p") step(state.step - 1, true);
    if (/^[1-8]$/.test(event.key)) step(Number(event.key) - 1, true);
  });
  const redraw = () => {
    for (const { plane } of state.order) plane.draw();
  };
  byId("floor").addEventListener("input", () => {
    state.floor = Number(byId("floor").value);
    byId("level").textContent = `${byId("floor").value.replace("-", "−")} dB`;
    redraw();
  });
  byId("guides").addEventListener("input", redraw);
  byId("save").addEventListener("click", () => {
    const link = make("a", null, { download: "explorer.ron" });
    link.href = URL.createObjectURL(new Blob([explorer.scene()], { type: "text/plain" }));
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
  byId("follow").addEventListener("click", follow);
  byId("reset").addEventListener("click", () => begin(""));
  addEventListener("hashchange", () => begin(location.hash));
};

const begin = (fragment) => {
  if (explorer) explorer.free();
  explorer = new wasm_bindgen.Explorer(fragment);
  // Without a scene of its own the page begins with the first step.
  step(0, fragment === "");
};

/** Slow planes are made beside the page, or where that may not be, once nothing moves. */
const work = (module) => {
  const code = [byId("glue").textContent, byId("background").textContent].join("\n");
  try {
    background = new Worker(URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
  } catch {
    return;
  }
  background.onmessage = answered;
  background.onerror = () => (background = null);
  background.postMessage({ module });
};

const start = async () => {
  const module = await WebAssembly.compile(bytes(byId("wasm").textContent));
  wasm_bindgen.initSync({ module });
  work(module);
  world = new World(byId("world"), get, set);
  buildSliders();
  listen();
  begin(location.hash);
  document.documentElement.dataset.ready = "yes";
};
start().catch((error) => (byId("words").textContent = `This browser does not run the page: ${error.message}`));
