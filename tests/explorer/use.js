"use strict";
// Uses the explorer as a student would, and holds its numbers against those of the command: run by .ci/explorer.
const { execFileSync, spawnSync } = require("node:child_process");
const { mkdtempSync, readFileSync, rmSync, writeFileSync } = require("node:fs");
const { tmpdir } = require("node:os");
const { join, resolve } = require("node:path");
const { Browser } = require("./browser.js");
const { array } = require("./npz.js");

const [page, program, pictures] = process.argv.slice(2);
const address = `file://${resolve(page)}`;
const faults = [];
const expect = (what, holds) => {
  if (!holds) faults.push(what);
};
const pause = (ms) => new Promise((wait) => setTimeout(wait, ms));

/** Between WebAssembly and the command, of the largest value: rounding of the same sums in the same order leaves none. */
const SAME = 1e-12;
/** The scenes whose numbers are compared; each but the first is one that a link may hold. */
const SCENES = {
  slats: "",
  open: "fill=0&travel=1.3&width=0.1",
  squares: "width=0.2&travel=2&at=1&pitch=0.2&fill=0.6&count=20&squares=1&jitter=0.3&window_x=0.5&window_u=0.5&rho_max=16&rho_step=1&nu_max=32&nu_step=1",
  beside: "position=0.083&pitch=0.071&fill=0.37&at=0.31&count=20",
  glossy: "glossy=1&curvature=0.8&exponent=100",
  near: "glossy=1&curvature=0.8&exponent=400&window_x=0.05&window_u=0.05&rho_step=10&rho_max=200&nu_max=40&nu_step=5&pitch=0.03&at=0.8",
  mirror: "glossy=1&curvature=0.8&exponent=2000",
  hollow: "glossy=1&curvature=-0.7&exponent=900&at=0.8",
};
/** Those of a curved glossy receiver are first-order, the command's are rays off the sphere. */
const FIRST_ORDER = ["curvature", "reflection", "leaving"];
/** What the cosine and higher orders take in windows of 0.25 rad, and in one of 0.05: a twenty-fifth, and the error of the command's nets of rays, 0.3 %. */
const FIRST_ORDER_OFF = { wide: 0.05, near: 0.005 };

const largest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
const difference = (a, b) => (a.length === b.length ? largest(a.map((value, i) => value - b[i])) / largest(b) : Infinity);
const norm = (values) => Math.sqrt(values.reduce((sum, value) => sum + value * value, 0));

/** What the page has at each plane. */
const numbers = (browser) =>
  browser.value(`explorer.planes().split("\\n").map((name, i) => ({
    name: name.replace("*", ""), field: [...explorer.field(i)], spectrum: [...explorer.spectrum(i)] }))`);

const predicted = (folder, { name, spectrum, field }) => {
  const file = join(folder, name, "prediction.npz");
  const slices = array(file, "slices").values.subarray(0, spectrum.length);
  return { spectrum: slices, field: array(file, "projection").values.subarray(0, field.length) };
};

const compare = async (browser, folder) => {
  for (const [scene, fragment] of Object.entries(SCENES)) {
    await browser.open(`${address}#${fragment}`);
    const file = join(folder, `${scene}.ron`);
    writeFileSync(file, await browser.value("explorer.scene()"));
    execFileSync(program, ["predict", file, "--quiet", "--out", join(folder, scene)]);
    let worst = 0;
    let followed = 0;
    const off = [];
    const glossy = fragment.includes("glossy=1");
    for (const plane of await numbers(browser)) {
      const command = predicted(join(folder, scene), plane);
      if (glossy && FIRST_ORDER.includes(plane.name)) {
        const share = norm(plane.spectrum.map((value, i) => value - command.spectrum[i])) / norm(command.spectrum);
        const values = await browser.value(`[...explorer.follow(explorer.planes().split("\\n").indexOf("${plane.name}"))]`);
        const [spectrum, field] = [values.slice(0, plane.spectrum.length), values.slice(plane.spectrum.length)];
        followed = Math.max(followed, difference(spectrum, command.spectrum), difference(field, command.field));
        expect(`${scene}: rays at ${plane.name} are the command's, ${followed.toExponential(1)}`, followed <= SAME);
        expect(`${scene}: ${plane.name} is the command's to first order, ${share}`, share <= FIRST_ORDER_OFF[scene === "near" ? "near" : "wide"]);
        off.push(`${plane.name} ${(100 * share).toFixed(1)} %`);
        continue;
      }
      for (const kind of ["spectrum", "field"]) {
        const apart = difference(plane[kind], command[kind]);
        worst = Math.max(worst, apart);
        expect(`${scene}: ${kind} at ${plane.name} is the command's, ${apart.toExponential(1)}`, apart <= SAME);
      }
    }
    console.log(`${scene}: differs from the command by ${worst.toExponential(1)} of the largest value${off.length ? `; by rays ${followed.toExponential(1)}; first order is off by ${off.join(", ")}` : ""}`);
  }
};

/** A travel that is off by a nanometre is seen, and so is a curved surface that bends by a tenth too much. */
const planted = async (browser, folder) => {
  await browser.open(address);
  await browser.value("explorer.set('travel', 1 + 1e-9)");
  const plane = (await numbers(browser)).find(({ name }) => name === "receiver");
  const apart = difference(plane.spectrum, predicted(join(folder, "slats"), plane).spectrum);
  console.log(`planted: a travel of 1 nm more differs by ${apart.toExponential(1)}`);
  expect("a wrong travel is seen", apart > SAME);
  await browser.open(`${address}#${SCENES.glossy}`);
  await browser.value("explorer.set('curvature', 0.88)");
  const curved = (await numbers(browser)).find(({ name }) => name === "curvature");
  const command = predicted(join(folder, "glossy"), curved).spectrum;
  const share = norm(curved.spectrum.map((value, i) => value - command[i])) / norm(command);
  console.log(`planted: a curvature of a tenth more differs by ${(100 * share).toFixed(1)} %`);
  expect("a wrong curvature is seen", share > FIRST_ORDER_OFF.wide);
};

/** From the report of a run to its scene. */
const linked = async (browser, folder) => {
  for (const scene of ["squares", "glossy"]) {
    const results = join(folder, `${scene}-run`);
    const ended = spawnSync(program, ["run", join(folder, `${scene}.ron`), "--photons", "4096", "--quiet", "--out", results]);
    expect(`${scene} is run`, [0, 1, 4].includes(ended.status));
    await browser.open(`file://${results}/report.html`, "document.documentElement?.dataset.drawn > 0");
    // After this call has its answer: an answer is lost when the page goes.
    await browser.value("void setTimeout(() => document.querySelector('a.explorer').click())");
    // The report is ready as well, until the explorer takes its place.
    await browser.until("typeof settle === 'function' && document.documentElement?.dataset.ready === 'yes' && (settle(), true)");
    expect(`the report leads to ${scene}`, (await browser.value("explorer.scene()")) === readFileSync(join(folder, `${scene}.ron`), "utf8"));
    expect("the page is the committed one", readFileSync(page).equals(readFileSync(join(results, "explorer.html"))));
  }
  console.log("reports lead to their scenes");
};

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** Drags a handle back and forth; work and time from one frame to the next, in milliseconds. */
const drag = async (browser, name, [dx, dy]) => {
  await browser.until("!state.pending && !state.busy");
  await browser.value("new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))");
  const { x, y } = await browser.value(`(() => {
    const box = world.grips.${name}.getBoundingClientRect();
    return { x: box.x + box.width / 2, y: box.y + box.height / (${name === "width" || name === "pitch"} ? 2 : 1.5) }; })()`);
  const before = await browser.value("explorer.fragment()");
  await browser.value(`(() => { frames.length = slowFrames.length = 0; const mine = (window.ticks = []);
    const tick = (t) => { mine.push(t); if (mine === ticks) requestAnimationFrame(tick); }; requestAnimationFrame(tick); })()`);
  await browser.mouse("mousePressed", x, y);
  for (let i = 1; i <= 60; i++) {
    const share = Math.sin((i / 60) * Math.PI * 1.5);
    await browser.mouse("mouseMoved", x + dx * share, y + dy * share);
  }
  await browser.mouse("mouseReleased", x - dx, y - dy);
  const { work, ticks, slow } = await browser.value("(() => { const all = ticks; ticks = null; return { work: [...frames], ticks: all, slow: slowFrames.length / 2 / ((all.at(-1) - all[0]) / 1000) }; })()");
  expect(`dragging ${name} changes the scene`, (await browser.value("explorer.fragment()")) !== before);
  return { work, slow, between: ticks.slice(1).map((t, i) => t - ticks[i]) };
};

const drags = async (browser) => {
  for (const scene of ["slats", "glossy"]) {
    await browser.size(1300, 1000);
    await browser.open(`${address}#${SCENES[scene]}`);
    const all = { work: [], between: [], slow: [] };
    const moves = { light: [0, 20], width: [0, -15], blockers: [40, 0], pitch: [0, -10], receiver: [60, 0] };
    if (scene === "glossy") moves.curvature = [15, 0];
    for (const [name, by] of Object.entries(moves)) {
      const { work, between, slow } = await drag(browser, name, by);
      all.work.push(...work);
      all.between.push(...between);
      all.slow.push(slow);
    }
    const told = (values) => `median ${median(values).toFixed(1)}, worst ${largest(values).toFixed(1)} ms`;
    console.log(`drag, ${scene}: ${all.work.length} frames; work ${told(all.work)}; from one to the next ${told(all.between)}${scene === 'slats' ? `; slow planes ${median(all.slow).toFixed(0)} times a second` : ''}`);
    expect("half of the frames leave time at 60 a second", median(all.work) < 16.7);
    await browser.until("!state.busy && !state.wanted && !state.pending");
  }
};

const looks = async (browser) => {
  for (const [width, isDark] of [[1300, false], [1300, true], [480, false]]) {
    await browser.size(width, 1000, isDark);
    await browser.open(address);
    const titles = [await browser.value("byId('title').textContent")];
    for (let i = 0; i < 8; i++) {
      if (pictures) {
        await pause(300);
        await browser.until("!state.busy && !state.wanted && !state.pending");
        writeFileSync(join(pictures, `${width}-${isDark ? "dark" : "light"}-${i + 1}.png`), await browser.picture());
      }
      await browser.press("n");
      titles.push(await browser.value("byId('title').textContent"));
    }
    expect("the tour has eight steps", new Set(titles).size === 8 && titles.every((title, i) => title.startsWith(String(Math.min(8, i + 1)))));
    await browser.press("3");
    expect("a key leads to each step", (await browser.value("byId('title').textContent")).startsWith("3"));
    expect("planes of a step are marked", (await browser.value("document.querySelectorAll('.told:not([hidden])').length")) === 2);
    expect("nothing is wider than the page", await browser.value("document.documentElement.scrollWidth <= innerWidth"));
    const paper = await browser.value("getComputedStyle(document.body).backgroundColor");
    expect("dark pages are dark", (paper !== "rgb(255, 255, 255)") === isDark);
    const columns = await browser.value("getComputedStyle(byId('planes')).gridTemplateColumns.split(' ').length");
    expect(`two planes beside each other on a narrow page, not ${columns}`, width > 640 ? columns > 3 : columns === 2);
  }
};

const keys = async (browser) => {
  await browser.size(1300, 1000);
  await browser.open(`${address}#${SCENES.beside}`);
  expect("a scene comes from the address", (await browser.value("['position', 'pitch', 'fill', 'at', 'count'].map(get).join()")) === "0.083,0.071,0.37,0.31,20");
  await browser.value("world.grips.receiver.focus()");
  await browser.press("ArrowRight");
  expect("arrow keys move the receiver", (await browser.value("explorer.get('travel')")) > 1.01);
  await browser.value("byId('pitch').focus()");
  await browser.press("ArrowRight");
  expect("arrow keys move sliders", (await browser.value("explorer.get('pitch')")) > 0.071);
  await browser.value("document.querySelectorAll('canvas')[7].focus()");
  await browser.press("ArrowRight");
  expect("a value is told", /^at the receiver: ρ = .* dB$/.test(await browser.value("byId('pointed').textContent")));
  await browser.value("set('glossy', 1)");
  await browser.until("!state.pending && byId('follow').hidden === false");
  await browser.press("r");
  await browser.until("state.order.slice(4).every(({ plane }) => /^by rays; first order is off by/.test(plane.words.textContent))");
  await browser.value("set('glossy', 0)");
  await browser.until("byId('scene').textContent === explorer.scene() && location.hash === '#' + explorer.fragment()");
  const before = await browser.value("state.planes.get('receiver').spectrumPicture.canvas.toDataURL()");
  await browser.value("byId('floor').value = '-20'; byId('floor').dispatchEvent(new Event('input'))");
  expect("the level changes colors", (await browser.value("state.planes.get('receiver').spectrumPicture.canvas.toDataURL()")) !== before);
};

const main = async () => {
  const browser = await Browser.start();
  const folder = mkdtempSync(join(tmpdir(), "explorer-"));
  try {
    await looks(browser);
    await keys(browser);
    await drags(browser);
    await compare(browser, folder);
    await planted(browser, folder);
    await linked(browser, folder);
    const asked = browser.everRequested.filter((url) => !/^(file|blob|data|about):/.test(url) || (url.startsWith("file:") && !/^[^#]*(report|explorer)\.html(#.*)?$/.test(url)));
    expect(`nothing is asked of the network: ${asked.join(" ")}`, asked.length === 0);
    expect(`the page wrote to the console: ${browser.console.join("; ")}`, browser.console.length === 0);
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true });
  }
  console.log(faults.length === 0 ? "the explorer: all is well" : faults.join("\n"));
  process.exitCode = faults.length === 0 ? 0 : 1;
};
main();
