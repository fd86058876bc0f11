"use strict";
// Reads arrays of numbers from NPZ files: a ZIP of NPY files, as `etendue predict` writes them.
const { readFileSync } = require("node:fs");
const { inflateRawSync } = require("node:zlib");

/** The entries of a ZIP file by name. */
const entries = (file) => {
  const data = readFileSync(file);
  const end = data.lastIndexOf(Buffer.from("PK\x05\x06", "latin1"));
  const found = {};
  let at = data.readUInt32LE(end + 16);
  for (let i = 0; i < data.readUInt16LE(end + 10); i++) {
    const [method, size, nameLength] = [data.readUInt16LE(at + 10), data.readUInt32LE(at + 20), data.readUInt16LE(at + 28)];
    const name = data.toString("utf8", at + 46, at + 46 + nameLength);
    const local = data.readUInt32LE(at + 42);
    const start = local + 30 + data.readUInt16LE(local + 26) + data.readUInt16LE(local + 28);
    const packed = data.subarray(start, start + size);
    found[name] = method === 0 ? packed : inflateRawSync(packed);
    at += 46 + nameLength + data.readUInt16LE(at + 30) + data.readUInt16LE(at + 32);
  }
  return found;
};

/** An array of a file: its shape and its numbers, those of complex ones by turns. */
const array = (file, name) => {
  const data = entries(file)[`${name}.npy`];
  const length = data.readUInt16LE(8);
  const header = data.toString("latin1", 10, 10 + length);
  if (!/'descr': '<(f8|c16)'/.test(header) || /'fortran_order': True/.test(header)) throw new Error(`${file}: ${header}`);
  const shape = /'shape': \(([^)]*)\)/.exec(header)[1].split(",").filter((n) => n.trim()).map(Number);
  const bytes = data.subarray(10 + length);
  return { shape, values: Float64Array.from({ length: bytes.length / 8 }, (_, i) => bytes.readDoubleLE(8 * i)) };
};
module.exports = { array };
