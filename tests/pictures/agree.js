// Whether three drawings of a figure show the same: its PNG, and its SVG and PDF as others draw them. Texts and edges are
// drawn by other hands, so colors are compared as means over blocks.
const BLOCK = 12;
// Largest difference of a block's mean color, of 255: letters moved by half a pixel make 25.
const MOST = 40;
// The same on average over all blocks.
const MEAN = 1.5;

function pixels(id, width, height) {
    const canvas = document.createElement("canvas");
    canvas.width = width;
    canvas.height = height;
    const context = canvas.getContext("2d");
    context.fillStyle = "white";
    context.fillRect(0, 0, width, height);
    context.drawImage(document.getElementById(id), 0, 0, width, height);
    return context.getImageData(0, 0, width, height).data;
}

// Mean colors of blocks, red, green and blue of one after the other.
function blocks(data, width, height) {
    const [columns, rows] = [width, height].map((n) => Math.ceil(n / BLOCK));
    const sums = new Float64Array(4 * columns * rows);
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
            const block = 4 * (Math.floor(y / BLOCK) * columns + Math.floor(x / BLOCK));
            const pixel = 4 * (y * width + x);
            for (let c = 0; c < 3; c++) sums[block + c] += data[pixel + c];
            sums[block + 3] += 1;
        }
    }
    return sums.map((sum, i) => sum / sums[4 * Math.floor(i / 4) + 3]);
}

function difference(a, b) {
    let [worst, sum] = [0, 0];
    for (let i = 0; i < a.length; i++) {
        const apart = Math.abs(a[i] - b[i]);
        worst = Math.max(worst, apart);
        sum += apart;
    }
    return [worst, sum / (0.75 * a.length)];
}

window.addEventListener("load", () => {
    const png = document.getElementById("png");
    const [width, height] = [png.naturalWidth, png.naturalHeight];
    const drawn = (id) => blocks(pixels(id, width, height), width, height);
    const truth = drawn("png");
    const found = ["svg", "pdf"].map((id) => [id, difference(truth, drawn(id))]);
    const well = found.every(([, [worst, mean]]) => worst < MOST && mean < MEAN);
    const said = found.map(([id, [worst, mean]]) => `${id} ${worst.toFixed(1)}, ${mean.toFixed(2)} on average`);
    document.body.dataset.answer = `${well ? "agree" : "differ"}: ${said.join("; ")}`;
});
