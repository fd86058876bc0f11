"""The 4D real transform against NumPy (values), SciPy and FFTW (speed).

usage: fft4d.py PROGRAM [ROUNDS] [SIZE ...]        e.g. fft4d.py target/release/examples/fft4d 9 64 96

PROGRAM is the example `fft4d` of etendue-transform. Needs numpy, scipy and pyfftw. Two threads for all.
Every contender is a process of its own that does one transform at a time when asked to, so the rounds alternate.
"""
import itertools, os, statistics, subprocess, sys, tempfile, time

os.environ["RAYON_NUM_THREADS"] = "2"
import numpy as np


def serve(name, n):
    """A contender: one transform for each line of the input, its milliseconds as the answer; peak megabytes at the end."""
    import scipy.fft, pyfftw

    reals = np.empty((n,) * 4)
    for i, block in enumerate(reals):  # no large array in passing: the peak counts
        block[...] = ((np.arange(n**3).reshape((n,) * 3) + i * n**3) * 0.618033988749895) % 1 - 0.5
    if name == "scipy":
        transform = lambda: scipy.fft.rfftn(reals, workers=2)
    elif name == "fftw":
        source = pyfftw.empty_aligned(reals.shape, "float64")
        spectrum = pyfftw.empty_aligned((n, n, n, n // 2 + 1), "complex128")
        transform = pyfftw.FFTW(source, spectrum, axes=range(4), threads=2, flags=("FFTW_MEASURE",))
        source[...] = reals
    elif name == "fftw in place":
        spectrum = pyfftw.empty_aligned((n, n, n, n // 2 + 1), "complex128")
        source = spectrum.view(np.float64)[..., :n]
        transform = pyfftw.FFTW(source, spectrum, axes=range(4), threads=2, flags=("FFTW_MEASURE",))
    for line in itertools.chain(["warm-up"], sys.stdin):
        if name == "fftw in place":
            source[...] = reals
        start = time.perf_counter()
        result = transform()
        milliseconds = (time.perf_counter() - start) * 1e3
        del result
        if line != "warm-up":
            print(milliseconds, flush=True)
    print(next(int(line.split()[1]) / 1e3 for line in open("/proc/self/status") if line.startswith("VmHWM")))


def check(program):
    """The largest difference from numpy.fft.rfftn, relative to its root mean square, over some shapes."""
    for shape in [(8, 8, 8, 8), (5, 6, 7, 9), (32, 24, 16, 20), (1, 13, 2, 31)]:
        reals = np.random.default_rng(1).uniform(-1, 1, shape)
        with tempfile.TemporaryDirectory() as folder:
            files = [os.path.join(folder, name) for name in ("in", "out")]
            reals.tofile(files[0])
            subprocess.run([program, "file", *map(str, shape), *files], check=True)
            found = np.fromfile(files[1], np.complex128)
        expected = np.fft.rfftn(reals)
        error = np.abs(found.reshape(expected.shape) - expected).max() / np.sqrt(np.mean(np.abs(expected) ** 2))
        print(f"{shape}: {error:.1e}")
        assert error < 1e-14  # rounding


class Contender:
    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.times = []

    def run(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        self.times.append(float(self.process.stdout.readline()))

    def finish(self):
        self.process.stdin.close()
        return float(self.process.stdout.readline())


def race(program, rounds, n):
    own = lambda memory: [program, "serve", str(n), memory]
    peer = lambda name: [sys.executable, __file__, "--serve", name, str(n)]
    commands = {
        "own, memory kept": own("kept"),
        "own, new memory": own("fresh"),
        "scipy (new memory)": peer("scipy"),
        "fftw, memory kept": peer("fftw"),
        "fftw in place, memory kept": peer("fftw in place"),
    }
    contenders = {name: Contender(command) for name, command in commands.items()}
    for contender in contenders.values():
        contender.run()  # waits until it is ready
        contender.times.clear()
    for _ in range(rounds):
        for contender in contenders.values():
            contender.run()
    scipy = contenders["scipy (new memory)"].times
    print(f"\n{n}^4, {rounds} rounds; load {os.getloadavg()[0]:.1f}")
    print(f"{'':36}{'median ms':>10}{'least ms':>10}{'/ scipy':>10}{'peak MB':>10}")
    for name, contender in contenders.items():
        times = contender.times
        ratio = statistics.median(a / b for a, b in zip(times, scipy))
        print(f"{name:36}{statistics.median(times):10.1f}{min(times):10.1f}{ratio:10.2f}{contender.finish():10.0f}")


if __name__ == "__main__":
    if sys.argv[1] == "--serve":
        serve(sys.argv[2], int(sys.argv[3]))
    else:
        check(sys.argv[1])
        for n in map(int, sys.argv[3:] or ["64", "96"]):
            race(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 9, n)
