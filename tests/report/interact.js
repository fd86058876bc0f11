"use strict";
// Uses a report as a reader would, and says in the page whether it answers: run by .ci/report.
const faults = [];
const expect = (what, holds) => {
  if (!holds) faults.push(what);
};
const canvases = [...document.querySelectorAll("canvas")];
const spectra = canvases.filter((canvas) => canvas.getAttribute("aria-label").includes("spectrum"));
const lines = () => [...document.querySelectorAll(".value")].map((line) => line.textContent);
const pixels = (canvas) => canvas.toDataURL();
const input = (id, value) => {
  const element = document.getElementById(id);
  element.value = value;
  element.dispatchEvent(new Event("input", { bubbles: true }));
};

expect("nothing is asked of the network", performance.getEntriesByType("resource").every((entry) => entry.name.startsWith("data:")));
expect("all pictures are drawn", Number(document.documentElement.dataset.drawn) === canvases.length && canvases.length >= 6);
expect("the verdict stands first", /^(pass|fail|undecided)/.test(document.querySelector(".verdict").textContent));
expect("the path is drawn", document.querySelector(".path img").src.startsWith("data:image/svg+xml,%3Csvg"));
const toExplorer = [...document.querySelectorAll("a.explorer")].map((link) => link.getAttribute("href"));
expect("the scene of fig9b leads to the explorer", toExplorer.length === 1 && /^\.\/((fig9b|javascript%3Aalert\(1\))\/)?explorer\.html#width=0\.2&travel=2&/.test(toExplorer[0]));
expect("nothing is wider than the page", document.documentElement.scrollWidth <= innerWidth);

const box = spectra[0].getBoundingClientRect();
const at = { clientX: box.left + 0.5 * box.width, clientY: box.top + 0.5 * box.height };
spectra[0].dispatchEvent(new PointerEvent("pointermove", at));
const pointed = lines();
expect("a value is told", /ρ = 0 .*measured .*dB, predicted .*dB, difference .*σ/.test(pointed[0]));
const linked = pointed.filter((line) => line.startsWith("ρ"));
expect("planes are linked", linked.length === spectra.length && linked.every((line) => line.includes("ρ = 0 ")));
spectra[0].focus();
spectra[0].dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
expect("arrow keys move the mark", !lines()[0].includes("ρ = 0 "));

const before = pixels(spectra[0]);
input("floor", "-30");
expect("the slider changes colors", pixels(spectra[0]) !== before);
expect("the slider tells its level", document.getElementById("level").textContent === "−30 dB");
const radial = pixels(spectra[0]);
input("azimuth", "1");
expect("azimuths differ from their mean", pixels(spectra[0]) !== radial);

const columns = getComputedStyle(document.querySelector(".pictures")).gridTemplateColumns.split(" ").length;
expect("pictures stand below each other on a narrow page", columns === (innerWidth <= 640 ? 1 : 3));
const paper = getComputedStyle(document.body).backgroundColor;
const dark = matchMedia("(prefers-color-scheme: dark)").matches;
expect("dark pages are dark", (paper === "rgb(255, 255, 255)") !== dark);
document.documentElement.dataset.answer = faults.length === 0 ? `all is well, ${innerWidth} wide, ${dark ? "dark" : "light"}` : faults.join("; ");
