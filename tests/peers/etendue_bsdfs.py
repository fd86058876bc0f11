"""BSDFs of exported scenes that Mitsuba 3 has no word for. Import it after mi.set_variant and before such a scene is loaded.

phong            the modified Phong lobe (Lafortune and Willems 1994) as Mitsuba 0.6 had it: ks (n + 2)/2π cosⁿ α on the front, α being the angle to the mirror direction
etendue_fresnel  a lobe times the Fresnel factor of the angle at which light arrives
"""
import drjit as dr, mitsuba as mi


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


mi.register_bsdf("phong", Phong)
mi.register_bsdf("etendue_fresnel", Fresnel)
