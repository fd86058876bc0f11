"""Arrays in xarray, pictures by matplotlib, and what notebooks show, of all objects that have arrays."""

import os
from pathlib import Path

import etendue
import numpy as np
import pytest

matplotlib = pytest.importorskip("matplotlib")
pytest.importorskip("xarray")
matplotlib.use("Agg")

SCENES = Path(__file__).parents[2] / "scenes"
FIG9B = SCENES / "fig9b.ron"
WINDOW, FREQUENCIES = {"x": {"Hann": 0.5}, "u": {"Hann": 0.5}}, {"rho": {"max": 4}, "nu": {"max": 6}}
SLICES, POWER, FIELD = ("azimuth", "rho", "nu"), ("rho", "nu"), ("x", "u")


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """An object of each kind, and the axes of its arrays."""
    rays = np.random.default_rng(1).uniform(-0.5, 0.5, (4, 4000))
    # After a metre, the spectrum is sheared towards ν = −ρ.
    rays[:2] = 0.2 * rays[:2] + rays[2:]
    spectrum = etendue.spectrum(*rays, window=WINDOW, frequencies=FREQUENCIES)
    plane = etendue.run(FIG9B, photons=2**14)["receiver"]
    x = np.linspace(-0.5, 0.5, 32)
    grid = etendue.grid_spectrum(np.exp(-((x[:, None] - x) ** 2) * 90), x=x, u=x, window=WINDOW, frequencies=FREQUENCIES, noise=0.1)
    fit = etendue.fit(FIG9B, etendue.measure(FIG9B, photons=2**14), ["surfaces.0.center.2", "blockers.0.fill"], starts=1)
    world = SCENES / "worlds/glossy.xml"
    picture = etendue.render(world, size=(64, 48), samples=4, out=tmp_path_factory.mktemp("picture"))
    probed = etendue.probe(world, (70, 95), rays=2**12, photons=2**12, out=tmp_path_factory.mktemp("probe"))
    return {
        "plane": (plane, {"measured": SLICES, "sigma": SLICES, "power": POWER, "predicted_power": POWER, "light_field": FIELD}),
        "spectrum": (spectrum, {"slices": SLICES, "slices_sigma": SLICES, "power": POWER, "light_field": FIELD}),
        "grid": (grid, {"slices": SLICES, "slices_sigma": SLICES, "power": POWER}),
        "difference": (etendue.difference(plane, etendue.run(FIG9B, photons=2**14, seed=2)["receiver"]), {"slices": SLICES, "z": SLICES}),
        "fit": (fit, {"value": ("field",), "correlations": ("field", "other_field")}),
        "picture": (picture, {"radiance": ("row", "column"), "error": ("row", "column")}),
        "probed": (probed.measured("camera"), {"slices": SLICES, "slices_sigma": SLICES}),
        "probe": (probed, None),
    }


KINDS = ["plane", "spectrum", "grid", "difference", "fit", "picture", "probed"]


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_have_named_axes(found, kind):
    shown, expected = found[kind]
    data = shown.to_xarray()
    for name, axes in expected.items():
        assert data[name].dims == axes, name
    units = {"azimuth": "rad", "rho": "cycles/m", "nu": "cycles/slope", "x": "m", "u": "slope"}
    for name in set(data.coords) & set(units):
        assert data[name].units == units[name]
    if "rho" in data.coords:
        # Frequencies have both signs in every array.
        assert np.array_equal(data.rho, -data.rho[::-1]) and np.array_equal(data.nu, -data.nu[::-1])


@pytest.mark.parametrize("kind", [*KINDS, "probe"])
def test_notebooks_show_a_picture(found, kind):
    html = found[kind][0]._repr_html_()
    assert html.count('<img alt="" src="data:image/png;base64,iVBOR') == 1 and "<script" not in html


@pytest.mark.parametrize("kind", ["plane", "spectrum", "grid", "probed", "difference"])
def test_rho_is_to_the_right_and_nu_upwards(found, kind):
    from matplotlib.figure import Figure

    ax = found[kind][0].plot(Figure().subplots())
    assert ax.get_xlabel().startswith("ρ") and ax.get_ylabel().startswith("ν")


def test_a_sheared_spectrum_is_drawn_sheared(found):
    """Light that has travelled by a metre has its power at ν = −ρ."""
    from matplotlib.figure import Figure

    ax = found["spectrum"][0].plot(Figure().subplots())
    mesh = ax.collections[0]
    corners, values = mesh.get_coordinates(), mesh.get_array()
    middles = 0.25 * (corners[1:, 1:] + corners[:-1, 1:] + corners[1:, :-1] + corners[:-1, :-1]).reshape(-1, 2)
    weight = 10 ** (np.asarray(values).ravel() / 10)
    assert (weight * middles[:, 0] * middles[:, 1]).sum() / (weight * middles[:, 0] ** 2).sum() < -0.5


def test_a_figure_is_a_path_that_notebooks_show(tmp_path):
    drawn = etendue.figure([etendue.Scene(FIG9B, photons=2**12)], plane="receiver", quality="draft", out=tmp_path)
    assert os.fspath(drawn).endswith("figure.png") and isinstance(drawn, Path)
    assert drawn._repr_png_() == drawn.read_bytes() and drawn._repr_png_().startswith(b"\x89PNG")
    assert drawn.parent._repr_png_() is None


def test_examples_are_scenes():
    assert etendue.run(etendue.examples["fig9b"], photons=2**12).name == "fig9b"
    assert {"letter", "table1/glossy"} < set(etendue.examples)
    for name, path in etendue.examples.items():
        try:
            etendue.check(path)
        except etendue.CannotRun as error:  # too little memory
            assert "memory" in str(error), name
