"use strict";
// The slow planes, in the background: the same numbers from the same theory.
let explorer = null;
onmessage = ({ data }) => {
  if (data.module) {
    wasm_bindgen.initSync({ module: data.module });
    return;
  }
  if (explorer) explorer.free();
  explorer = new wasm_bindgen.Explorer(data.fragment);
  for (const { name, index } of data.follow || []) postMessage({ name, key: data.fragment, followed: explorer.follow(index) });
  if (data.follow) return;
  if (data.isCoarse) explorer.coarsen();
  for (const { name, index } of data.planes) {
    const [axes, field, spectrum] = [explorer.axes(), explorer.field(index), explorer.spectrum(index)];
    postMessage({ name, key: data.fragment, isCoarse: data.isCoarse, axes, field, spectrum }, [field.buffer, spectrum.buffer]);
  }
  postMessage({ done: true });
};
