"""Light fields by rays drawn in a plane's window and traced back by Mitsuba's path integrator."""
import drjit as dr, mitsuba as mi, numpy as np

from mitsuba_planes import rays_of, rows
from slices import transform


class Rays:
    """Draws rays of a plane's window and asks Mitsuba, backwards, for their radiance."""

    def __init__(self, world, plane):
        self.world, self.plane = world, plane
        self.light = next((shape for shape in world.scene.shapes() if shape.is_emitter()), None)
        self.path = mi.load_dict({"type": "path", "max_depth": 2 if plane.leg else 1})
        if self.light is not None:
            box = self.light.bbox()
            low, high = np.array(box.min)[:2], np.array(box.max)[:2]
            self.center, self.size = 0.5 * (low + high), high - low

    def slices(self, rng, n):
        """Slices [K, ρ ≥ 0, ν] of one batch of n rays, and how many of them carry light."""
        plane = self.plane
        if plane.leg > 0:
            rays, weight = self.leaving(rng, n)
        elif plane.is_on_surface or self.light is None:
            rays, weight = self.towards_light(rng, n)
        else:
            rays, weight = self.across(rng, n)
        with np.errstate(invalid="ignore"):
            weight = np.where(weight > 0, weight * plane.factor(rays), 0) / n
        kept = weight != 0
        return transform(rays[:, kept], weight[kept], plane.grid), np.count_nonzero(kept)

    def across(self, rng, n):
        """Before any surface, across the ray. Two of these are drawn: positions, slopes, both by the window, and a point of the light;
        those two that leave the least to chance."""
        plane, window = self.plane, self.plane.window
        volume = [window[0].integral * window[1].integral, window[2].integral * window[3].integral]
        area, distance = np.prod(self.size), plane.distance
        choices = {"xyuv": volume[0] * volume[1], "uv": area * volume[1]}
        choices["xy"] = volume[0] * area / distance**2 if distance > 0 else np.inf
        drawn = min(choices, key=choices.get)
        rays = np.array([w.draw(rng, n) for w in window])
        at_light = self.center[:, None] + self.size[:, None] * rng.uniform(-0.5, 0.5, (2, n))
        if drawn == "uv":
            rays[:2] = at_light + distance * rays[2:]
        elif drawn == "xy":
            rays[2:] = (rays[:2] - at_light) / distance
        # The density is the window where the window was drawn by: the rest of it is left.
        left = plane.in_window(rays, "".join(set("xyuv") - set(drawn))) if drawn != "xyuv" else 1.0
        x, y, u, v = rays[:, :, None]
        along = plane.d + u * plane.x + v * plane.y
        start = plane.origin + x * plane.x + y * plane.y + plane.aside * along
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        return rays, choices[drawn] * left * self.found(start, along, rng)

    def towards_light(self, rng, n):
        """Before any surface: points by the window, directions by Mitsuba's lights."""
        plane, window = self.plane, self.plane.window
        x, y = window[0].draw(rng, n), window[1].draw(rng, n)
        point, axes, area, exists = plane.point(x, y)
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(int(rng.integers(2**31)), n)
        at = dr.zeros(mi.SurfaceInteraction3f, n)
        # Beside what stands in the plane; the ray is moved by so much times its slope.
        beside = point + (0 if plane.is_on_surface else plane.aside) * plane.d
        at.p, at.t = mi.Point3f(beside.T.astype("f4")), mi.Float(0)
        # The surface that ends the leg does not stand in the way of its own light.
        scene = self.world.without(plane.ends)
        drawn, light = scene.sample_emitter_direction(at, sampler.next_2d(), True)
        light = np.array(light[0], float) * np.ones(n)
        away = rows(drawn.d)
        if plane.is_on_surface:
            u, v, cosine = plane.angles(axes, away)
            # dω = cos φ dθ dφ.
            weight = np.where((cosine > 0) & exists, light * area / np.cos(v), 0)
        else:
            u, v, squared = plane.slopes(-away)
            weight = np.where(away @ plane.d < 0, light * squared**1.5, 0)
        rays = np.array([x, y, u, v])
        weight = np.where(point[:, 2] >= 0, weight * plane.in_window(rays, "uv"), 0)
        return rays, weight * window[0].integral * window[1].integral

    def leaving(self, rng, n):
        """After surfaces: all by the window."""
        plane = self.plane
        rays = np.array([w.draw(rng, n) for w in plane.window])
        x, y, u, v = rays
        if plane.is_on_surface:
            point, axes, area, exists = plane.point(x, y)
            along = plane.away(axes, u, v) * (-1 if plane.arrives else 1)
        else:
            point, area, exists = plane.origin + x[:, None] * plane.x + y[:, None] * plane.y, 1.0, True
            along = plane.d + u[:, None] * plane.x + v[:, None] * plane.y
            along /= np.linalg.norm(along, axis=1, keepdims=True)
        # Light counts whose line does not meet the surface again: from far ahead it is the first that is met.
        leaves = self.world.part([plane.visits[-1]])
        last = leaves.ray_intersect(rays_of(point + plane.far * along, -along))
        start = rows(last.p)
        exists = exists & np.array(last.is_valid())
        travelled = np.sum((point - start) * along, axis=1)
        if plane.is_local and not plane.arrives:
            exists = exists & (np.abs(travelled) < abs(plane.aside))
        others = self.world.without(plane.visits[-1], plane.ends)
        if others is not None:
            barred = others.ray_intersect(rays_of(start, along))
            exists = exists & (np.array(barred.t, float) > travelled + plane.aside)
        start = np.where(exists[:, None], start, 0)
        found = self.found(start + abs(plane.aside) * along, along, rng)
        volume = np.prod([w.integral for w in plane.window])
        return rays, np.where(exists, volume * area * found, 0)

    def found(self, start, along, rng):
        """Radiance along rays: back over the surfaces of the path, and from the first of them to the light."""
        n = len(start)
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(int(rng.integers(2**31)), n)
        ray, active, weight = mi.RayDifferential3f(rays_of(start, -along)), mi.Bool(True), mi.Float(1)
        for place, name in reversed(list(enumerate(self.plane.visits))):
            si = self.world.scene.ray_intersect(ray, active)
            surface = self.world.shapes[name]
            active &= si.shape == mi.ShapePtr(surface)
            if place > 0:
                drawn, share = surface.bsdf().sample(mi.BSDFContext(), si, sampler.next_1d(active), sampler.next_2d(active), active)
                weight *= dr.select(active, share[0], 0)
                ray = mi.RayDifferential3f(si.spawn_ray(si.to_world(drawn.wo)))
        radiance, _, _ = self.path.sample(self.world.scene, sampler, ray, None, active)
        return np.array(dr.select(active, weight * radiance[0], 0), float).reshape(-1) * np.ones(n)
