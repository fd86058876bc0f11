"""Light fields by photons: Mitsuba's emitters send rays, its BSDFs send them on, and planes count them. For lights that no ray finds that is traced back."""
import drjit as dr, mitsuba as mi, numpy as np

from mitsuba_planes import rows
from slices import transform


class Photons:
    def __init__(self, world, planes):
        self.world, self.planes = world, planes
        self.emitter, = world.scene.emitters()

    def batch(self, rng, n):
        """For each plane slices [K, ρ ≥ 0, ν], and how many photons they are of."""
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(int(rng.integers(2**31)), n)
        ray, weight = self.emitter.sample_ray(0.0, sampler.next_1d(), sampler.next_2d(), sampler.next_2d())
        # One ray in some millions comes with an infinite weight: its pixel has no density (Mitsuba 3.9.1).
        active = dr.isfinite(weight[0])
        flux, start, normals = dr.select(active, mi.Float(weight[0]) / n, 0), rows(ray.o), None
        context = mi.BSDFContext(mi.TransportMode.Importance)
        seen = {}
        for leg in range(1 + max(plane.leg for plane in self.planes)):
            si = self.world.scene.ray_intersect(ray, active)
            here = [plane for plane in self.planes if plane.leg == leg]
            begun = np.array(active & (flux > 0)) * np.ones(n, bool)
            for plane in here:
                seen[plane.name] = self.slices(plane, start, rows(ray.d), flux, begun, si, normals)
            later = [plane for plane in self.planes if plane.leg > leg]
            if not later:
                break
            surface = self.world.shapes[later[0].visits[leg]]
            active &= si.shape == mi.ShapePtr(surface)
            bsdf = surface.bsdf()
            # An interface lets all light through in Étendue: what Mitsuba reflects of it is put back.
            goes_through = mi.has_flag(bsdf.flags(), mi.BSDFFlags.DeltaTransmission)
            context.type_mask = int(mi.BSDFFlags.DeltaTransmission) if goes_through else int(mi.BSDFFlags.All)
            drawn, share = bsdf.sample(context, si, sampler.next_1d(active), sampler.next_2d(active), active)
            share = dr.select(share[0] > 0, 1.0, 0.0) if goes_through else share[0]
            flux = dr.select(active, flux * share, 0)
            # Mitsuba's next ray begins some 10⁻⁴ m beside the surface; light is counted from the surface on.
            ray, start, normals = si.spawn_ray(si.to_world(drawn.wo)), rows(si.p), rows(si.sh_frame.n)
        return [seen[plane.name] for plane in self.planes]

    @np.errstate(divide="ignore", invalid="ignore")  # of rays that have ended
    def slices(self, plane, start, along, flux, begun, si, normals):
        flux, reach = np.array(flux, float) * np.ones(len(start)), np.array(si.t, float)
        met_end = np.array(si.shape == mi.ShapePtr(self.world.shapes[plane.ends])) if plane.ends else np.zeros(len(start), bool)
        # Its line does not meet the surface it leaves again.
        if plane.visits:
            begun = begun & ~np.array(si.is_valid() & (si.shape == mi.ShapePtr(self.world.shapes[plane.visits[-1]])))
        if plane.is_local:
            point = rows(si.p) if plane.arrives else start
            axes = plane.frames(rows(si.sh_frame.n) if plane.arrives else normals)
            begun = begun & (met_end if plane.arrives else True)
            met = reach if plane.arrives else np.zeros(len(start))
        else:
            met = ((plane.origin - start) @ plane.d) / (along @ plane.d)
            point = start + met[:, None] * along
            axes = (plane.x, plane.y, plane.d)
        # What stands before the plane takes light away, but for the surface that ends the leg.
        begun = begun & (met_end | (met + plane.aside < reach))
        x, y = (point - plane.origin) @ plane.x, (point - plane.origin) @ plane.y
        if plane.is_on_surface:
            u, v, cosine = plane.angles(axes, -along if plane.arrives else along)
            begun = begun & (cosine > 0)
            per_flux = 1 / np.where(begun, cosine * np.cos(v), 1)
        else:
            u, v, squared = plane.slopes(along)
            per_flux = squared**2
        rays = np.array([x, y, u, v])
        weight = np.where(begun, flux * per_flux * plane.in_window(rays) * plane.factor(rays), 0)
        kept = weight != 0
        return transform(rays[:, kept], weight[kept], plane.grid), np.count_nonzero(kept)
