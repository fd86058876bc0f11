/** A light field or a spectrum on a canvas, with lines over it. */
class Picture {
  constructor(plane, kind) {
    Object.assign(this, { plane, kind });
    const box = make("div", plane.box, { class: "picture" });
    const label = `${plane.name.replaceAll("_", " ")}: ${kind === "field" ? "light field" : "spectrum"}`;
    this.upwards = make("div", box, { class: "numbers beside", "aria-hidden": "true" });
    const view = make("div", box, { class: "view" });
    this.level = make("div", box, { class: "numbers level", "aria-hidden": "true" });
    this.canvas = make("canvas", view, { tabindex: "0", role: "img", "aria-label": label });
    this.context = this.canvas.getContext("2d");
    this.over = document.createElementNS(SVG, "svg");
    this.over.setAttribute("viewBox", "-1 -1 2 2");
    this.over.setAttribute("preserveAspectRatio", "none");
    view.append(this.over);
    this.lines = [0, 1].map(() => this.over.appendChild(document.createElementNS(SVG, "line")));
    this.mark = this.over.appendChild(document.createElementNS(SVG, "circle"));
    this.mark.setAttribute("class", "mark");
    this.mark.setAttribute("r", "0.06");
    this.mark.style.display = "none";
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerdown", (event) => this.point(event));
    this.canvas.addEventListener("keydown", (event) => this.key(event));
  }
  point(event) {
    const box = this.canvas.getBoundingClientRect();
    tell(this, [(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height]);
  }
  key(event) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    event.preventDefault();
    const from = state.at && state.at.picture === this ? state.at.share : [0, 0];
    const cells = [this.canvas.width, this.canvas.height];
    tell(this, from.map((share, i) => Math.min(0.999, Math.max(-0.999, share + (2 * step[i]) / cells[i]))));
  }
  /** Numbers at both ends of the axes and, between them, their names. */
  scale([across, name], [upwards, upName]) {
    const texts = (end, middle) => [`−${digits(end)}`, middle, digits(end)];
    const show = (box, all) => box.replaceChildren(...all.map((text) => make("span", null, {}, text)));
    show(this.level, texts(across, name));
    show(this.upwards, texts(upwards, upName).reverse());
  }
  /** `share(i, j)` of `width` × `height` cells, as places on the color bar. */
  draw(width, height, share) {
    if (!this.image || this.image.width !== width || this.image.height !== height) {
      Object.assign(this.canvas, { width, height });
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    }
    for (let i = 0; i < width; i++) {
      for (let j = 0; j < height; j++) this.pixels[(height - 1 - j) * width + i] = shade(share(i, j));
    }
    this.context.putImageData(this.image, 0, 0);
  }
  /** Lines through the middle, of these slopes in shares of the picture. */
  line(slopes) {
    this.lines.forEach((line, i) => {
      // What is seen at infinity is upright.
      const slope = slopes[i] && Math.max(-1e4, Math.min(1e4, slopes[i]));
      line.style.display = slope === undefined ? "none" : "";
      if (slope === undefined) return;
      const ends = { x1: -1, y1: -slope, x2: 1, y2: slope };
      for (const [key, value] of Object.entries(ends)) line.setAttribute(key, String(value));
    });
  }
}

/** A place on the path: its heading and its two pictures. */
class Plane {
  constructor(name) {
    this.name = name;
    this.key = "";
    this.box = make("section", byId("planes"), { class: "plane" });
    this.title = make("h3", this.box);
    this.words = make("p", this.box);
    this.fieldPicture = new Picture(this, "field");
    this.spectrumPicture = new Picture(this, "spectrum");
  }
  head() {
    const [title, words] = TITLES[this.name];
    this.title.textContent = title;
    this.words.textContent = this.name === "leaving" && get("glossy") > 0 ? "back from the normals: curvature again" : words;
  }
  /** As theory has it in closed form. */
  first(index) {
    if (this.followed) this.head();
    this.followed = false;
    this.show({ axes: explorer.axes(), field: explorer.field(index), spectrum: explorer.spectrum(index) });
  }
  show({ axes, field, spectrum }) {
    Object.assign(this, { axes, field, spectrum });
    this.draw();
  }
  draw() {
    if (!this.field) return;
    const [cells, halfX, halfU, rho, rhoStep, nu, nuStep] = this.axes;
    this.fieldPicture.scale([halfX, "x (m)"], [halfU, "u"]);
    this.spectrumPicture.scale([(rho + 0.5) * rhoStep, "ρ (1/m)"], [(nu + 0.5) * nuStep, "ν"]);
    const most = this.field.reduce((a, b) => (b > a ? b : a), 1e-300);
    this.fieldPicture.draw(cells, cells, (i, j) => this.field[i * cells + j] / most);
    const width = 2 * nu + 1;
    const power = new Float64Array(this.spectrum.length / 2);
    let peak = 1e-300;
    for (let i = 0; i < power.length; i++) {
      power[i] = this.spectrum[2 * i] ** 2 + this.spectrum[2 * i + 1] ** 2;
      if (power[i] > peak) peak = power[i];
    }
    this.peak = peak;
    const toLevel = 10 / Math.LN10 / -state.floor;
    const share = power.map((value) => 1 + toLevel * Math.log(value / peak + 1e-300));
    this.spectrumPicture.draw(2 * rho + 1, width, (i, j) => (i >= rho ? share[(i - rho) * width + j] : share[(rho - i) * width + width - 1 - j]));
    this.spectrumPicture.line(byId("guides").checked ? this.slopes() : []);
    this.fieldPicture.line([]);
    if (state.at && state.at.picture.plane === this) tell(state.at.picture, state.at.share);
  }
  /** What rays found in the place of first order. */
  follow(values) {
    const size = this.spectrum.length;
    const [spectrum, field] = [values.subarray(0, size), values.subarray(size)];
    const norm = (of) => Math.sqrt(spectrum.reduce((sum, value, i) => sum + of(value, i) ** 2, 0));
    const off = norm((value, i) => value - this.spectrum[i]) / norm((value) => value);
    this.words.textContent = `by rays; first order is off by ${digits(100 * off, 2)} %`;
    this.followed = true;
    this.show({ axes: explorer.axes(), field, spectrum });
  }
  /** ν = −h ρ of the light and of the blockers, as shares of the picture. */
  slopes() {
    const [, , , rho, rhoStep, nu, nuStep] = this.axes;
    const scale = (rho * rhoStep) / (nu * nuStep);
    const [at, travel, fill] = [get("at"), get("travel"), get("fill")];
    const blocked = fill > 0 ? [travel - at] : [];
    const bend = get("curvature") * { curvature: 1, reflection: 1, leaving: get("glossy") > 0 ? 2 : 0 }[this.name];
    const seen = (h) => h / (1 + bend * h);
    const from = { light: [0], before_blockers: [at], after_blockers: fill > 0 ? [at, 0] : [at], receiver: [travel, ...blocked], irradiance: [travel, ...blocked] };
    if (from[this.name]) return from[this.name].map((h) => h * scale);
    if (this.name === "leaving" && get("glossy") === 0) return [0];
    const turned = this.name === "curvature" ? -1 : 1;
    return [travel, ...blocked].map((h) => turned * scale * seen(h));
  }
}
