"""A BSDF that Mitsuba has no word for: a lobe times the Fresnel factor of the angle at which light arrives.

Import it after mi.set_variant and before a scene with <bsdf type="etendue_fresnel"> is loaded. Only one of the directions of a lobe is met by light
first: as wi where photons are followed, as wo where paths are traced back. So it is not reciprocal, as docs/scene.md says.
"""
import drjit as dr, mitsuba as mi


class Fresnel(mi.BSDF):
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.n, self.k = props["n"], props["k"]
        self.lobe = next(props[name] for name in props.keys() if isinstance(props[name], mi.BSDF))
        self.m_components = [self.lobe.flags(i) for i in range(self.lobe.component_count())]
        self.m_flags = self.lobe.flags()

    def factor(self, context, wi, wo):
        light = wi if context.mode == mi.TransportMode.Importance else wo
        return mi.fresnel_conductor(dr.maximum(light.z, 0), dr.scalar.Complex2f(self.n, -self.k))

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


mi.register_bsdf("etendue_fresnel", Fresnel)
