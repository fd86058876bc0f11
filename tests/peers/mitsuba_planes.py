"""The virtual planes of an exported scene, and what stands around them in Mitsuba: coordinates of rays as docs/conventions.md has them.

Points and directions are arrays [n, 3]; normals and points of surfaces are Mitsuba's own.
"""
import mitsuba as mi, numpy as np

from slices import Profile


def rays_of(start, along):
    return mi.Ray3f(mi.Point3f(start.T.astype("f4")), mi.Vector3f(along.T.astype("f4")))


def rows(vector):
    """Vectors of Mitsuba as an array."""
    return np.array(vector, float).T


class World:
    """A loaded scene, and parts of it."""

    def __init__(self, scene):
        self.scene, self.parts = scene, {}
        self.shapes = {shape.id(): shape for shape in scene.shapes()}

    def part(self, keep):
        """The scene with shapes of these identifiers alone, and its lights; None without shapes."""
        keep = frozenset(keep)
        if keep not in self.parts:
            objects = {f"s{i}": self.shapes[name] for i, name in enumerate(sorted(keep))}
            lights = [e for e in self.scene.emitters() if mi.has_flag(e.flags(), mi.EmitterFlags.Infinite)]
            objects |= {f"e{i}": light for i, light in enumerate(lights)}
            self.parts[keep] = mi.load_dict({"type": "scene", **objects}, optimize=False) if objects else None
        return self.parts[keep]

    def without(self, *names):
        return self.part(set(self.shapes) - set(names))


class Plane:
    """A plane's frame and window, and how rays are seen in it."""

    def __init__(self, written, world, length):
        self.written, self.world = written, world
        self.name, self.leg, self.grid = written["name"], written["leg"], written["frequencies"]
        self.visits, self.ends, self.distance = written["visits"], written["ends"], written["distance"]
        self.origin, self.x, self.y, self.d = (np.array(written["frame"][axis]) for axis in "OXYD")
        self.window = [Profile(written["window"][axis]) for axis in "xyuv"]
        self.is_on_surface = written["orientation"] != "Orthogonal"
        self.is_local = written["orientation"] in ("LocalNormals", "Mirrored")
        self.turned = -1.0 if written["orientation"] == "Mirrored" else 1.0
        self.longitude = written["longitude"]
        self.arrives = written["side"] == "before"
        # What is looked at a little before the plane, towards the light, or after it, stands beside what stands in it.
        self.aside = (-1e-4 if self.arrives else 1e-4) * length
        self.far = 10 * length
        self.surface = self.ends if self.arrives else (self.visits[-1] if self.visits else None)

    def in_window(self, rays, axes="xyuv"):
        return np.prod([self.window["xyuv".index(a)](rays["xyuv".index(a)]) for a in axes], axis=0)

    def factor(self, rays):
        """What its quantity multiplies radiance by."""
        if self.written["quantity"] == "Radiance":
            return 1.0
        _, _, u, v = rays
        if not self.is_on_surface:
            return (1 + u**2 + v**2) ** -2.0
        return np.cos(u + self.longitude) * np.cos(v) ** 2

    def frames(self, normals):
        """T, B and N turned with the normals, by the smallest angles."""
        sides = np.sign(normals @ self.d)[:, None]
        normals = sides * normals
        turn = (self.d + normals) / (1 + normals @ self.d)[:, None]
        return *(axis - (normals @ axis)[:, None] * turn for axis in (self.x, self.y)), normals

    def point(self, x, y):
        """Points at coordinates, the axes there, dA over dx dy, and whether there is such a point."""
        foot = self.origin + x[:, None] * self.x + y[:, None] * self.y
        if not self.is_local:
            axes = [np.broadcast_to(axis, foot.shape) for axis in (self.x, self.y, self.d)]
            return foot, axes, np.ones(len(foot)), np.ones(len(foot), bool)
        alone = self.world.part([self.surface])
        si = alone.ray_intersect(rays_of(foot + self.far * self.d, -self.d + 0 * foot))
        axes = self.frames(rows(si.sh_frame.n))
        return rows(si.p), axes, 1 / np.maximum(axes[2] @ self.d, 1e-9), np.array(si.is_valid())

    def away(self, axes, u, v):
        """Directions away from a surface by their angles."""
        theta, phi = self.turned * (u + self.longitude), self.turned * v
        t, b, n = axes
        return np.cos(phi)[:, None] * (np.sin(theta)[:, None] * t + np.cos(theta)[:, None] * n) + np.sin(phi)[:, None] * b

    def angles(self, axes, away):
        """The inverse, and the cosine of the angle to the normal."""
        t, b, n = (np.sum(away * axis, axis=1) for axis in axes)
        return self.turned * np.arctan2(t, n) - self.longitude, self.turned * np.arcsin(np.clip(b, -1, 1)), n

    def slopes(self, along):
        """Across the ray: (u, v), and 1 + u² + v²."""
        ahead = along @ self.d
        u, v = (along @ self.x) / ahead, (along @ self.y) / ahead
        return u, v, 1 + u**2 + v**2
