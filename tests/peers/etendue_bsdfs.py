"""BSDFs of exported scenes that Mitsuba 3 has no word for. Import it after mi.set_variant and before such a scene is loaded.

phong            the modified Phong lobe (Lafortune and Willems 1994) as Mitsuba 0.6 had it: ks (n + 2)/2π cosⁿ α on the front, α being the angle to the mirror direction
etendue_fresnel  a lobe times the Fresnel factor of the angle at which light arrives
etendue_coat     Mitsuba's roughplastic, with the transmittance of its coat by a fine quadrature (Walter et al. 2007). Mitsuba's own table makes the
                 base up to 2.3 % darker than that of smooth plastic, which is its limit at a roughness of zero.
"""
import math
import drjit as dr, mitsuba as mi, numpy as np


class Phong(mi.BSDF):
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.exponent = props["exponent"]
        self.specular = props.get_texture("specular_reflectance")
        if props.get_texture("diffuse_reflectance", 0.0).max() > 0:
            raise RuntimeError("phong: only without a diffuse part")
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.SpatiallyVarying]
        self.m_flags = self.m_components[0]

    def shape(self, wi, wo):
        """cosⁿ α, and whether both directions are in front."""
        cosine = dr.clip(wi.z * wo.z - wi.x * wo.x - wi.y * wo.y, 0, 1)
        return cosine**self.exponent, (wi.z > 0) & (wo.z > 0)

    def eval(self, context, si, wo, active=True):
        lobe, front = self.shape(si.wi, wo)
        value = self.specular.eval(si, active) * ((self.exponent + 2) / (2 * dr.pi) * lobe * wo.z)
        return dr.select(front & active, value, 0)

    def pdf(self, context, si, wo, active=True):
        lobe, front = self.shape(si.wi, wo)
        return dr.select(front & active, (self.exponent + 1) / (2 * dr.pi) * lobe, 0)

    def eval_pdf(self, context, si, wo, active=True):
        return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)

    def sample(self, context, si, sample1, sample2, active=True):
        cosine = sample2.x ** (1 / (self.exponent + 1))
        sine = dr.sqrt(dr.maximum(1 - cosine**2, 0))
        turn = 2 * dr.pi * sample2.y
        mirrored = mi.Frame3f(mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z))
        drawn = dr.zeros(mi.BSDFSample3f)
        drawn.wo = mirrored.to_world(mi.Vector3f(sine * dr.cos(turn), sine * dr.sin(turn), cosine))
        drawn.pdf = self.pdf(context, si, drawn.wo, active)
        drawn.eta, drawn.sampled_component, drawn.sampled_type = 1.0, mi.UInt32(0), mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        return drawn, dr.select(drawn.pdf > 0, self.eval(context, si, drawn.wo, active) / drawn.pdf, 0)

    def to_string(self):
        return f"Phong[exponent={self.exponent}]"


class Fresnel(mi.BSDF):
    """Only one of the directions of a lobe is met by light first: wi where photons are followed, wo where paths are traced back."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.n, self.k = props["n"], props["k"]
        self.lobe = next(props[name] for name in props.keys() if isinstance(props[name], mi.BSDF))
        self.m_components = [self.lobe.flags(i) for i in range(self.lobe.component_count())]
        self.m_flags = self.lobe.flags()

    def factor(self, context, wi, wo):
        light = wi if context.mode == mi.TransportMode.Importance else wo
        return mi.fresnel_conductor(dr.maximum(light.z, 0), mi.Complex2f(self.n, self.k))

    def sample(self, context, si, sample1, sample2, active=True):
        drawn, weight = self.lobe.sample(context, si, sample1, sample2, active)
        return drawn, weight * self.factor(context, si.wi, drawn.wo)

    def eval(self, context, si, wo, active=True):
        return self.lobe.eval(context, si, wo, active) * self.factor(context, si.wi, wo)

    def pdf(self, context, si, wo, active=True):
        return self.lobe.pdf(context, si, wo, active)

    def eval_pdf(self, context, si, wo, active=True):
        return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)

    def to_string(self):
        return f"Fresnel[n={self.n}, k={self.k}, {self.lobe}]"


def smith(direction, alpha, is_ggx):
    slope = alpha * np.hypot(direction[..., 0], direction[..., 1]) / np.maximum(np.abs(direction[..., 2]), 1e-300)
    if is_ggx:
        return 2 / (1 + np.sqrt(1 + slope**2))
    a = np.minimum(1 / np.maximum(slope, 1e-300), 26)
    return 2 / (1 + np.vectorize(math.erf)(a) + np.exp(-a * a) / (a * math.sqrt(math.pi)))


def over_normals(cosine, alpha, is_ggx, eta, is_transmitted):
    """The share of light at this cosine that a rough interface transmits or reflects, over its visible normals (Heitz 2018), by Gauss's rule."""
    s, weight = np.polynomial.legendre.leggauss(48)
    s = 0.5 + 0.5 * s
    # The nodes are dense where normals are steep.
    weight = (1.5 * (1 - s)**2 * weight)[:, None] / 64
    radius, angle = np.sqrt(1 - (1 - s)**3)[:, None], 2 * np.pi * (np.arange(64) + 0.5) / 64
    wo = np.array([math.sqrt(1 - cosine**2), 0, cosine])
    view = wo * [alpha, 1, 1]
    view = view / np.linalg.norm(view)
    up = np.cross(view, [0, 1, 0])
    t1, seen = radius * np.cos(angle), 0.5 * (1 + view[2])
    t2 = (1 - seen) * np.sqrt(1 - t1**2) + seen * radius * np.sin(angle)
    t3 = np.sqrt(np.maximum(1 - t1**2 - t2**2, 0))
    m = t1[..., None] * [0, 1, 0] + t2[..., None] * up + t3[..., None] * view
    m = m * [alpha, alpha, 1]
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    if not is_ggx:
        slope2 = (1 / m[..., 2]**2 - 1) / alpha**2
        weight = weight * np.exp(-slope2) * (1 + slope2)**2 * smith(wo, alpha, False) / smith(wo, alpha, True)
    c = m @ wo
    sine2 = (1 - c**2) / eta**2
    ct = np.sqrt(np.maximum(1 - sine2, 0))
    fresnel = np.where(sine2 < 1, 0.5 * (((c - eta * ct) / (c + eta * ct))**2 + ((eta * c - ct) / (eta * c + ct))**2), 1)
    wi = (c / eta - ct)[..., None] * m - wo / eta if is_transmitted else 2 * c[..., None] * m - wo
    leaves = wi[..., 2] < 0 if is_transmitted else wi[..., 2] > 0
    return float((weight * np.where(leaves, (1 - fresnel if is_transmitted else fresnel) * smith(wi, alpha, is_ggx), 0)).sum())


class Coat(mi.BSDF):
    STEPS = 256    # of the root of the cosine

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        number = lambda name, default: props[name] if name in props else default
        named = {"air": 1.000277, "bk7": 1.5046, "polypropylene": 1.49, "vacuum": 1.0}
        index = lambda name, default: named.get(number(name, default), number(name, default))
        self.eta = index("int_ior", 1.49) / index("ext_ior", 1.000277)
        alpha, is_ggx = number("alpha", 0.1), number("distribution", "beckmann") == "ggx"
        self.facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX if is_ggx else mi.MicrofacetType.Beckmann, alpha, True)
        self.diffuse = props.get_texture("diffuse_reflectance", 0.5)
        self.specular = props.get_texture("specular_reflectance", 1.0)
        self.nonlinear = number("nonlinear", False)
        cosines = np.linspace(0.003, 1, self.STEPS + 1)**2
        self.through = mi.Float(np.array([over_normals(c, alpha, is_ggx, self.eta, True) for c in cosines]))
        # Uniform light from within meets the coat at cosines whose squares are uniform.
        within = np.sqrt((np.arange(512) + 0.5) / 512)
        self.within = float(np.mean([over_normals(c, alpha, is_ggx, 1 / self.eta, False) for c in within]))
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide, mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def transmitted(self, cosine):
        at = dr.clip((dr.sqrt(dr.maximum(cosine, 0)) - 0.003) / 0.997, 0, 1) * self.STEPS
        i = dr.minimum(mi.UInt32(at), self.STEPS - 1)
        share = at - i
        return dr.lerp(dr.gather(mi.Float, self.through, i), dr.gather(mi.Float, self.through, i + 1), share)

    def parts(self, si, wo, active):
        """The coat and the base, times the cosine."""
        wi = si.wi
        half = dr.normalize(wi + wo)
        coat = self.facets.eval(half) * self.facets.G(wi, wo, half) * mi.fresnel(dr.dot(wi, half), self.eta)[0] / (4 * wi.z)
        albedo = self.diffuse.eval(si, active)
        again = albedo * self.within if self.nonlinear else self.within
        base = albedo / (1 - again) * self.transmitted(wi.z) * self.transmitted(wo.z) / (self.eta**2 * dr.pi) * wo.z
        return coat * self.specular.eval(si, active), base

    def eval(self, context, si, wo, active=True):
        coat, base = self.parts(si, wo, active)
        return dr.select(active & (si.wi.z > 0) & (wo.z > 0), coat + base, 0)

    def pdf(self, context, si, wo, active=True):
        wi = si.wi
        half = dr.normalize(wi + wo)
        coat = self.facets.eval(half) * self.facets.smith_g1(wi, half) / (4 * wi.z)
        return dr.select(active & (wi.z > 0) & (wo.z > 0), 0.5 * (coat + wo.z / dr.pi), 0)

    def eval_pdf(self, context, si, wo, active=True):
        return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)

    def sample(self, context, si, sample1, sample2, active=True):
        half, _ = self.facets.sample(si.wi, sample2)
        drawn = dr.zeros(mi.BSDFSample3f)
        drawn.wo = dr.select(sample1 < 0.5, mi.reflect(si.wi, half), mi.warp.square_to_cosine_hemisphere(sample2))
        drawn.pdf = self.pdf(context, si, drawn.wo, active)
        drawn.eta, drawn.sampled_component, drawn.sampled_type = 1.0, mi.UInt32(0), mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        return drawn, dr.select(drawn.pdf > 0, self.eval(context, si, drawn.wo, active) / drawn.pdf, 0)

    def to_string(self):
        return f"Coat[eta={self.eta}]"


mi.register_bsdf("phong", Phong)
mi.register_bsdf("etendue_fresnel", Fresnel)
mi.register_bsdf("etendue_coat", Coat)
