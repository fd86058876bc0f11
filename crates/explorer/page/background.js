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
  for (const { name, index } of data.planes) {
    const [field, spectrum] = [explorer.field(index), explorer.spectrum(index)];
    postMessage({ name, key: data.key, field, spectrum }, [field.buffer, spectrum.buffer]);
  }
  postMessage({ done: true });
};
