/** The scene from the side: z to the right, x up, and handles to drag. */
const SVG = "http://www.w3.org/2000/svg";
const VIEW = { width: 960, height: 300, left: 50, meter: 415, up: 420 };
const z = (meters) => VIEW.left + VIEW.meter * meters;
const MIDDLE = 135;
const x = (meters) => MIDDLE - VIEW.up * meters;

class World {
  /** `get(name)` and `set(name, value)` are the numbers of the scene. */
  constructor(svg, get, set) {
    Object.assign(this, { svg, get, set, dragged: null });
    this.parts = {};
    this.back = this.add("g", {});
    for (const [name, kind] of [["fan", "polygon"], ["axis", "line"], ["window", "line"], ["light", "line"], ["slats", "path"], ["receiver", "path"]]) {
      const look = { fan: "fan", axis: "ray dashed", window: "window", light: "light", slats: "slat", receiver: "receiver" }[name];
      this.parts[name] = this.add(kind, { class: look });
    }
    this.labels = ["light", "blockers", "receiver"].map((text, i) => {
      const label = this.add("text", { y: VIEW.height - 8, "text-anchor": i < 2 ? "middle" : "start" });
      label.textContent = text;
      return label;
    });
    // Wide invisible lines to take hold of, then small handles for what has no line of its own.
    this.grips = {
      light: this.grip("path", "position of the light", (p) => this.set("position", p.x), ["position", 1, 0.01]),
      blockers: this.grip("path", "distance of the blockers", (p) => this.set("at", p.z), ["at", 0, 0.02]),
      receiver: this.grip("path", "distance of the receiver", (p) => this.set("travel", p.z), ["travel", 0, 0.02]),
      width: this.grip("circle", "width of the light", (p) => this.set("width", 2 * Math.abs(p.x - this.get("position"))), ["width", 1, 0.004]),
      pitch: this.grip("circle", "pitch of the blockers", (p) => this.set("pitch", Math.abs(p.x) / this.nearest()), ["pitch", 1, 0.004]),
      curvature: this.grip("circle", "curvature of the receiver", (p) => this.set("curvature", this.bent(p.z)), ["curvature", 0, 0.02]),
    };
    svg.addEventListener("pointermove", (event) => this.move(event));
    svg.addEventListener("pointerup", () => (this.dragged = null));
    svg.addEventListener("pointercancel", () => (this.dragged = null));
  }
  add(kind, attributes) {
    const element = document.createElementNS(SVG, kind);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    this.svg.append(element);
    return element;
  }
  grip(kind, label, drag, [name, isUp, step]) {
    const look = kind === "circle" ? { r: 11, class: "handle" } : { class: "grip" };
    const element = this.add(kind, { ...look, tabindex: "0", role: "slider", "aria-label": label });
    element.addEventListener("pointerdown", (event) => {
      this.dragged = drag;
      this.svg.setPointerCapture(event.pointerId);
      event.preventDefault();
      element.focus();
    });
    element.addEventListener("keydown", (event) => {
      const keys = isUp ? ["ArrowDown", "ArrowUp"] : ["ArrowLeft", "ArrowRight"];
      const way = keys.indexOf(event.key);
      if (way < 0) return;
      event.preventDefault();
      this.set(name, this.get(name) + (way ? step : -step));
    });
    element.name = name;
    return element;
  }
  move(event) {
    if (!this.dragged) return;
    const box = this.svg.getBoundingClientRect();
    const scale = VIEW.width / box.width;
    this.dragged({
      z: ((event.clientX - box.left) * scale - VIEW.left) / VIEW.meter,
      x: (MIDDLE - (event.clientY - box.top) * scale) / VIEW.up,
    });
  }
  /** Which blocker, counted from the middle, the handle of the pitch is on. */
  nearest() {
    const odd = this.get("count") % 2;
    return odd ? 1 : 0.5;
  }
  /** The receiver is drawn this high, and this much deeper than it is. */
  bent(at) {
    return (at - this.get("travel")) / (0.5 * World.HIGH ** 2) / World.DEEPER;
  }
  draw() {
    const get = this.get;
    const [light, at, end] = [0, get("at"), get("travel")].map(z);
    const [width, position, h] = [get("width"), get("position"), get("window_x")];
    const put = (element, attributes) => {
      for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    };
    const { fan, axis, window, light: lamp, slats, receiver } = this.parts;
    const [top, bottom] = [position + width / 2, position - width / 2].map(x);
    put(fan, { points: `${light},${top} ${end},${x(position + h)} ${end},${x(position - h)} ${light},${bottom}` });
    put(axis, { x1: light, x2: end, y1: x(position), y2: x(position) });
    put(window, { x1: end - 8, x2: end - 8, y1: x(position + h), y2: x(position - h) });
    put(lamp, { x1: light, x2: light, y1: top, y2: bottom });
    const [pitch, fill, count] = [get("pitch"), get("fill"), get("count")];
    const slat = (i) => {
      const middle = (i - (count - 1) / 2) * pitch;
      const [top, bottom] = [middle + (fill * pitch) / 2, middle - (fill * pitch) / 2].map((meters) => Math.min(VIEW.height - 34, x(meters)));
      return bottom > 0 && top < bottom ? `M${at} ${top}V${bottom}` : "";
    };
    put(slats, { d: fill > 0 ? [...Array(count).keys()].map(slat).join("") : "" });
    const glossy = get("glossy") > 0;
    const depth = glossy ? VIEW.meter * World.DEEPER * 0.5 * get("curvature") * World.HIGH ** 2 : 0;
    const high = World.HIGH;
    put(receiver, { d: `M${end + depth} ${x(position + high)}Q${end - depth} ${x(position)} ${end + depth} ${x(position - high)}` });
    const line = (at) => `M${at} 10V${VIEW.height - 34}`;
    put(this.grips.light, { d: `M${light} ${top - 14}V${bottom + 14}` });
    put(this.grips.blockers, { d: line(at) });
    put(this.grips.receiver, { d: line(end) });
    put(this.grips.width, { cx: light, cy: top });
    put(this.grips.pitch, { cx: at, cy: x(this.nearest() * pitch), visibility: fill > 0 ? "visible" : "hidden" });
    put(this.grips.curvature, { cx: end + depth, cy: x(position + high), visibility: glossy ? "visible" : "hidden" });
    this.labels.forEach((label, i) => put(label, { x: [light, at, end - 20][i], visibility: i === 1 && fill === 0 ? "hidden" : "visible" }));
    for (const grip of Object.values(this.grips)) put(grip, { "aria-valuenow": get(grip.name) });
  }
}
World.HIGH = 0.25;
World.DEEPER = 3;
