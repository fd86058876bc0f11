"""The fields of a scene as types: written by `write_types.py` from the JSON schema, as `etendue schema` prints it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypedDict, Union

if TYPE_CHECKING:
    from typing_extensions import NotRequired


class Axis(TypedDict):
    """A frequency axis from −max to +max."""

    max: float
    """Highest frequency, rounded up to a multiple of the spacing. 1e-9 to 1e9"""
    spacing: NotRequired[Union[float, None]]
    """Spacing; 1/(2 · half-width of the window) unless stated, and never wider. 1e-9 to 1e9"""


class BlockersGrating(TypedDict):
    """A semi-transparent cosine grating over the whole plane: ½ (1 + m cos(2π f t + p)), t being x or y."""

    Grating: "BlockersGratingFields"


class BlockersGratingFields(TypedDict):
    axis: "AxisName"
    """The axis along which it varies"""
    center: Sequence[float]
    """Point from which t is counted, world coordinates"""
    frequency: float
    """f, cycles per metre. 1e-9 to 1e9"""
    modulation: NotRequired[float]
    """m. 0 to 1"""
    name: str
    """Name"""
    phase: NotRequired[float]
    """p, radians. -1000 to 1000"""


class BlockersJitteredSquares(TypedDict):
    """`count[0]` × `count[1]` squares on a jittered grid, edges along X and Y."""

    JitteredSquares: "BlockersJitteredSquaresFields"


class BlockersJitteredSquaresFields(TypedDict):
    center: Sequence[float]
    """Centre of the grid, world coordinates"""
    count: Sequence[int]
    """Squares along X and along Y"""
    fill: float
    """Side of a square as a share of the pitch. above 0, at most 1"""
    jitter: NotRequired[float]
    """Each square is moved by U(−jitter/2, jitter/2) pitches along X and along Y. 0 to 1 − fill"""
    name: str
    """Name, for planes to refer to"""
    pitch: float
    """Distance between grid points. 1e-9 to 1e9"""
    seed: NotRequired[int]
    """Seed of the jitter. 0 to 2^64 − 1"""


class BlockersMesh(TypedDict):
    """An opaque triangle mesh, anywhere between the light and the end of the path."""

    Mesh: "BlockersMeshFields"


class BlockersMeshFields(TypedDict):
    center: Sequence[float]
    """Where the mesh's origin is put, world coordinates"""
    mesh: "MeshSource"
    """The triangles"""
    name: str
    """Name"""
    scale: NotRequired[float]
    """Factor on the mesh's coordinates. 1e-9 to 1e9"""


class BlockersShapes(TypedDict):
    """Opaque shapes one by one; they must not overlap."""

    Shapes: "BlockersShapesFields"


class BlockersShapesFields(TypedDict):
    center: Sequence[float]
    """Point from which their coordinates along X and Y are counted, world coordinates"""
    name: str
    """Name"""
    shapes: Sequence["Shape"]
    """The shapes"""


class Brdf(TypedDict):
    """A BRDF."""

    albedo: NotRequired[float]
    """Factor on it, 0 to 1. 0 to 1"""
    fresnel: NotRequired["Fresnel"]
    """Its Fresnel factor"""
    incoming: NotRequired[Union[Sequence[float], None]]
    """A factor of the angle at which light comes: values at equal steps from the normal to 90 degrees, linear in between; 1 unless stated"""
    lobe: "Lobe"
    """Its lobe"""
    outgoing: NotRequired[Union[Sequence[float], None]]
    """The same of the angle at which light leaves"""


class BulbDisc(TypedDict):
    """A disc with this radius."""

    Disc: float
    """1e-9 to 1e9"""


class BulbSquare(TypedDict):
    """A square with this side, edges along X and Y."""

    Square: float
    """1e-9 to 1e9"""


class EnvironmentFile(TypedDict):
    """An OpenEXR picture over latitude and longitude, W m⁻² sr⁻¹; the path is relative to the scene file, and stays inside its folder."""

    File: str


class EnvironmentLobes(TypedDict):
    """A sum of lobes."""

    Lobes: Sequence["LightLobe"]


class EventReflects(TypedDict):
    """Reflects by a BRDF, on the side it faces; black on the other."""

    Reflects: "EventReflectsFields"


class EventReflectsFields(TypedDict):
    blend: NotRequired[Union["Pattern", None]]
    """What weights the BRDF where there is another"""
    brdf: "Brdf"
    """The BRDF"""
    other: NotRequired[Union["Brdf", None]]
    """Another BRDF that is added to it, weighted by 1 − `blend`"""
    texture: NotRequired[Union["Pattern", None]]
    """What multiplies the BRDF"""


class EventRefraction(TypedDict):
    """Lets it through by Snell's law; nothing is reflected."""

    Refraction: "EventRefractionFields"


class EventRefractionFields(TypedDict):
    back: float
    """Index on the other side. 0.1 to 10"""
    front: float
    """Index of refraction on the side it faces. 0.1 to 10"""


class EventSum(TypedDict):
    """Reflects by a weighted sum of BRDFs, on the side it faces; black on the other."""

    Sum: "EventSumFields"


class EventSumFields(TypedDict):
    terms: Sequence["Term"]
    """The BRDFs with their weights, 1 to 8 of them. The first says where the central ray goes on, as far as the path does not"""
    texture: NotRequired[Union["Pattern", None]]
    """What multiplies their sum"""


class EventThinLens(TypedDict):
    """A thin lens, flat, with this focal length."""

    ThinLens: float
    """a focal length in metres, negative if the lens spreads light, not 0"""


class FormCylinder(TypedDict):
    """A circular cylinder with this curvature; its axis is across `along`."""

    Cylinder: float
    """-1e6 to 1e6"""


class FormParaboloid(TypedDict):
    """A paraboloid with these curvatures at its vertex, the first along `along`."""

    Paraboloid: Sequence[float]


class FormSphere(TypedDict):
    """A sphere with this curvature, 1/R."""

    Sphere: float
    """-1e6 to 1e6"""


class Frequencies(TypedDict):
    """The frequencies of the slices."""

    azimuths: NotRequired[int]
    """Number K of azimuths πk/K. 1 to 1024"""
    nu: "Axis"
    """Angular frequency ν, cycles per unit slope"""
    rho: "Axis"
    """Spatial frequency ρ, cycles per metre"""


class FresnelConductor(TypedDict):
    """At a conductor with index n + i k."""

    Conductor: "FresnelConductorFields"


class FresnelConductorFields(TypedDict):
    k: float
    """k. 0 to 20"""
    n: float
    """n. 0.05 to 20"""


class FresnelDielectric(TypedDict):
    """At a dielectric with this index of refraction."""

    Dielectric: float
    """0.05 to 20"""


class Grating(TypedDict):
    """The grating of a picture or a pattern."""

    axis: "AxisName"
    """The axis along which it varies"""
    frequency: float
    """f, cycles per unit of the picture, or per metre of a surface. 1e-9 to 1e9"""
    modulation: NotRequired[float]
    """m. 0 to 1"""
    phase: NotRequired[float]
    """p, radians. -1e9 to 1e9"""


class Image(TypedDict):
    """A smooth picture: exp(−π (a²/w₁² + b²/w₂²)), times a grating ½ (1 + m cos(2π f t + p)) if it has one."""

    grating: NotRequired[Union["Grating", None]]
    """Its grating"""
    width: Sequence[float]
    """w₁ and w₂ along X and along Y"""


class LightBeam(TypedDict):
    """A collimated beam along the central ray whose irradiance is a picture."""

    Beam: "LightBeamFields"


class LightBeamFields(TypedDict):
    center: Sequence[float]
    """Where the central ray begins, world coordinates"""
    image: "Image"
    """The picture, in metres along X and along Y"""
    irradiance: NotRequired[float]
    """Irradiance where the picture is 1, W m⁻². 1e-9 to 1e9"""


class LightDisc(TypedDict):
    """A Lambertian disc orthogonal to the central ray, dark on its back."""

    Disc: "LightDiscFields"


class LightDiscFields(TypedDict):
    center: Sequence[float]
    """Centre, world coordinates"""
    radiance: NotRequired[float]
    """Radiance, W m⁻² sr⁻¹. 1e-9 to 1e9"""
    radius: float
    """Radius. 1e-9 to 1e9"""


class LightEnvironment(TypedDict):
    """Light from far away; that alone shines which comes from before the plane across `path.direction` at the centre."""

    Environment: "LightEnvironmentFields"


class LightEnvironmentFields(TypedDict):
    center: Sequence[float]
    """Where the central ray begins, world coordinates"""
    front: NotRequired[Sequence[float]]
    """Direction of the middle of the map, any length: its part orthogonal to `up` is used"""
    map: "Environment"
    """How much comes from where"""
    scale: NotRequired[float]
    """Factor on the map. 1e-9 to 1e9"""
    up: NotRequired[Sequence[float]]
    """Direction of the map's top, any length"""


LightLobe = TypedDict("LightLobe", {"from": "Sequence[float]", "radiance": "NotRequired[float]", "width": "float"})


class LightPoint(TypedDict):
    """A point that shines alike in all directions."""

    Point: "LightPointFields"


class LightPointFields(TypedDict):
    center: Sequence[float]
    """Where it is, world coordinates"""
    intensity: NotRequired[float]
    """Intensity, W sr⁻¹. 1e-9 to 1e9"""


class LightProjector(TypedDict):
    """A slide projector: a point whose intensity is a picture over slopes."""

    Projector: "LightProjectorFields"


class LightProjectorFields(TypedDict):
    center: Sequence[float]
    """Where it is, world coordinates"""
    image: "Image"
    """The picture, over slopes along X and along Y"""
    intensity: NotRequired[float]
    """Intensity where the picture is 1, W sr⁻¹. 1e-9 to 1e9"""


class LightRays(TypedDict):
    """The rays of a file, as they go through the plane across `path.direction` at the centre; those that go back from it are left out."""

    Rays: "LightRaysFields"


class LightRaysFields(TypedDict):
    center: Sequence[float]
    """Where the origin of the file is, and where the central ray begins, world coordinates"""
    file: str
    """IES TM-25, MCPL or NPY; the path is relative to the scene file, and stays inside its folder"""
    flux: NotRequired[Union[float, None]]
    """Flux of all rays of the file, W. Left out: what the file says; it must say so in W, or in lm with its total in W and lm. 1e-9 to 1e9"""
    front: NotRequired[Union[Sequence[float], None]]
    """Direction of the file's Z axis, any length. Left out: `path.direction`"""
    up: NotRequired[Union[Sequence[float], None]]
    """Direction of the file's Y axis, any length: its part orthogonal to `front` is used. Left out: that of the central ray's frame"""


class LightRectangle(TypedDict):
    """A Lambertian rectangle orthogonal to the central ray, edges along X and Y, dark on its back."""

    Rectangle: "LightRectangleFields"


class LightRectangleFields(TypedDict):
    center: Sequence[float]
    """Centre, world coordinates"""
    radiance: NotRequired[float]
    """Radiance, W m⁻² sr⁻¹. 1e-9 to 1e9"""
    size: Sequence[float]
    """Side lengths along X and Y"""


class LightSpot(TypedDict):
    """A flat bulb whose radiance falls off as cosⁿθ from the central ray."""

    Spot: "LightSpotFields"


class LightSpotFields(TypedDict):
    bulb: "Bulb"
    """Its shape"""
    center: Sequence[float]
    """Centre, world coordinates"""
    exponent: float
    """The exponent n. 0 to 10000"""
    radiance: NotRequired[float]
    """Radiance along the central ray, W m⁻² sr⁻¹. 1e-9 to 1e9"""


class LobeBeckmann(TypedDict):
    """Microfacets with Beckmann's distribution of normals, with this roughness α."""

    Beckmann: float
    """0.001 to 1"""


class LobeGgx(TypedDict):
    """Microfacets with the GGX distribution, with this roughness α."""

    Ggx: float
    """0.001 to 1"""


class LobePhong(TypedDict):
    """cosⁿ of the angle to the mirror direction, with this n."""

    Phong: float
    """0 to 10000"""


class MeshSourceFile(TypedDict):
    """An OBJ or PLY file; the path is relative to the scene file, and stays inside its folder."""

    File: str


class MeshSourceParaboloid(TypedDict):
    """A generated piece of the paraboloid z = −(k₁ x² + k₂ y²)/2 around the origin, facing along z."""

    Paraboloid: "MeshSourceParaboloidFields"


class MeshSourceParaboloidFields(TypedDict):
    cells: int
    """Cells along a side, of two triangles each. 1 to 2048"""
    curvatures: Sequence[float]
    """k₁ and k₂, per metre: positive if it is convex"""
    half: float
    """It reaches to ± this along x and along y. 1e-9 to 1e8"""


class MeshSourceStar(TypedDict):
    """A generated closed surface around the origin, r = radius · (1 + relief · sinˡθ · cos lφ) with l lobes around z."""

    Star: "MeshSourceStarFields"


class MeshSourceStarFields(TypedDict):
    lobes: int
    """Number of lobes around the axis. 0 to half the rings"""
    radius: float
    """Mean radius. 1e-9 to 1e8"""
    relief: float
    """Height of the lobes as a share of the radius. -0.9 to 0.9"""
    rings: int
    """Rings from pole to pole. 2 to 2048"""


class Path(TypedDict):
    """The central ray: it leaves the light's centre and goes from surface to surface, each sending it towards the centre of the
next."""

    direction: Sequence[float]
    """Direction in which it leaves the light; any length"""
    leaves: NotRequired[Union[Sequence[float], None]]
    """Direction in which it leaves the last of them, any length: straight back unless stated"""
    visits: Sequence[str]
    """Names of the surfaces it visits, in the order of light"""
    x_axis: Sequence[float]
    """The X axis: its part orthogonal to the direction is used"""


class PatternCheckerboard(TypedDict):
    """1 and 0 by turns on squares; two of their sides make this period."""

    Checkerboard: float
    """1e-9 to 1e9"""


class PatternCosine(TypedDict):
    """½ (1 + m cos(2π f t + p)), t along `along` or across it."""

    Cosine: "PatternCosineFields"


class PatternCosineFields(TypedDict):
    axis: "AxisName"
    """The axis along which it varies: X is `along`"""
    frequency: float
    """f, cycles per metre. 1e-9 to 1e9"""
    modulation: NotRequired[float]
    """m. 0 to 1"""
    phase: NotRequired[float]
    """p, radians. -1e9 to 1e9"""


class PatternPicture(TypedDict):
    """A picture around the vertex, 0 beyond its edge: X to its right, Y to its top, seen from where the surface faces."""

    Picture: "PatternPictureFields"


class PatternPictureFields(TypedDict):
    file: str
    """An OpenEXR or PNG file of numbers from 0 to 1; the path is relative to the scene file, and stays inside its folder"""
    size: Sequence[float]
    """Width along X and height along Y, metres"""


class PlaceAfter(TypedDict):
    """In the plane of these blockers, after them; or of this surface, as light leaves it."""

    After: str


class PlaceBefore(TypedDict):
    """In the plane of these blockers or this surface, before light meets them."""

    Before: str


class PlaceDistance(TypedDict):
    """At this distance from the light, along the path."""

    Distance: float
    """0 to the end of the path"""


class Plane(TypedDict):
    """A virtual plane."""

    at: "Place"
    """Where on the path"""
    frequencies: NotRequired[Union["Frequencies", None]]
    """Its own frequencies"""
    name: str
    """Name: the folder of its results"""
    orientation: NotRequired["Orientation"]
    """What its coordinates are counted from"""
    quantity: NotRequired["Quantity"]
    """What it records"""
    window: NotRequired[Union["Window", None]]
    """Its own window"""


class ProfileBox(TypedDict):
    """1 on |t| < h."""

    Box: float
    """1e-9 to 1e9"""


class ProfileGaussian(TypedDict):
    """exp(−π t² / width²), cut at |t| < cut."""

    Gaussian: "ProfileGaussianFields"


class ProfileGaussianFields(TypedDict):
    cut: float
    """Half-width of the support. 1e-9 to 1e9"""
    width: float
    """The width: the full integral of the uncut Gaussian. 1e-9 to 1e9"""


class ProfileHann(TypedDict):
    """cos²(π t / 2h) on |t| < h."""

    Hann: float
    """1e-9 to 1e9"""


class Run(TypedDict):
    """How the scene is measured."""

    alpha: NotRequired[float]
    """Share of true scenes the verdict may reject, over all planes. 1e-6 to 0.5"""
    batches: NotRequired[int]
    """Independent batches the errors come from. 32 to 1024: errors come from the spread of batches"""
    emission: NotRequired["Emission"]
    """How photons leave the light"""
    photons: NotRequired[int]
    """Photons emitted; 1e7 is a number too. one for each batch to 10^12"""
    resolution: NotRequired[float]
    """Noise, as a share of the spectrum, above which a plane does not pass. 0.0001 to 1"""
    sampling: NotRequired["Sampling"]
    """The numbers that photons are drawn from"""
    seed: NotRequired[int]
    """Seed of the photons. 0 to 2^64 − 1"""


class Scene(TypedDict):
    """A scene file as a tree."""

    as_printed: NotRequired[bool]
    """Whether geometric steps are predicted by the paper's equations as they are printed (9, 10, 11 and 19)"""
    blockers: NotRequired[Sequence["Blockers"]]
    """What stands in its way"""
    description: NotRequired[str]
    """What the scene shows, for the reader"""
    frequencies: "Frequencies"
    """The frequencies of every plane that does not state its own"""
    light: "Light"
    """Where light comes from"""
    path: "Path"
    """The central ray"""
    planes: Sequence["Plane"]
    """Where light is looked at"""
    run: NotRequired["Run"]
    """How it is measured"""
    surfaces: NotRequired[Sequence["Surface"]]
    """What it falls on"""
    window: "Window"
    """The window of every plane that does not state its own"""


class ShapeDisc(TypedDict):
    """A disc."""

    Disc: "ShapeDiscFields"


class ShapeDiscFields(TypedDict):
    center: Sequence[float]
    """Centre along X and Y"""
    radius: float
    """Radius. 1e-9 to 1e9"""


class ShapeHalfPlane(TypedDict):
    """Everything on one side of a line."""

    HalfPlane: "ShapeHalfPlaneFields"


class ShapeHalfPlaneFields(TypedDict):
    axis: "AxisName"
    """The axis along which the coordinate is compared with the edge"""
    edge: float
    """Coordinate of the edge. -1e9 to 1e9"""
    opaque: "HalfName"
    """The side that is opaque"""


class ShapeRectangle(TypedDict):
    """A rectangle, edges along X and Y."""

    Rectangle: "ShapeRectangleFields"


class ShapeRectangleFields(TypedDict):
    center: Sequence[float]
    """Centre along X and Y"""
    size: Sequence[float]
    """Side lengths along X and Y"""


class SurfaceMesh(TypedDict):
    """A triangle mesh, Lambertian on both sides unless it is smooth."""

    Mesh: "SurfaceMeshFields"


class SurfaceMeshFields(TypedDict):
    albedo: NotRequired[float]
    """Reflected over incident flux, if it is Lambertian. 0 to 1"""
    center: Sequence[float]
    """Where the mesh's origin is put, world coordinates"""
    event: NotRequired[Union["Event", None]]
    """What it does to light as a smooth surface, with normals interpolated between its vertices"""
    mesh: "MeshSource"
    """The triangles"""
    name: str
    """Name"""
    scale: NotRequired[float]
    """Factor on the mesh's coordinates. 1e-9 to 1e9"""


class SurfaceRectangle(TypedDict):
    """A Lambertian rectangle, edges along X and Y unless it faces elsewhere."""

    Rectangle: "SurfaceRectangleFields"


class SurfaceRectangleFields(TypedDict):
    albedo: NotRequired[float]
    """Reflected over incident flux. 0 to 1"""
    center: Sequence[float]
    """Centre, world coordinates"""
    facing: NotRequired[Union[Sequence[float], None]]
    """Its normal, any length: back along `path.direction` unless stated. Its edges are then along the part of the path's
X axis that is orthogonal to it (of Y, if X is along it), and across"""
    name: str
    """Name, for the path and the planes to refer to"""
    size: Sequence[float]
    """Side lengths along X and Y"""


class SurfaceSmooth(TypedDict):
    """A smooth piece of a plane, sphere, cylinder or paraboloid that reflects or refracts."""

    Smooth: "SurfaceSmoothFields"


class SurfaceSmoothFields(TypedDict):
    along: NotRequired[Union[Sequence[float], None]]
    """Direction of the first curvature, any length: the path's X axis unless stated (Y, if it faces along X); its part
orthogonal to the normal is used"""
    aperture: float
    """Its radius, seen along the normal. 1e-9 to 1e9"""
    center: Sequence[float]
    """Its vertex, world coordinates"""
    event: "Event"
    """What it does"""
    facing: Sequence[float]
    """Its normal at the vertex, any length"""
    form: "Form"
    """Its form"""
    name: str
    """Name"""


class Term(TypedDict):
    """A BRDF of a sum."""

    brdf: "Brdf"
    """The BRDF"""
    weight: NotRequired[Union["Pattern", None]]
    """How much of it there is at each place: 1 unless stated"""


class Window(TypedDict):
    """The window: a profile for each coordinate; y and v are as x and u unless stated."""

    u: "Profile"
    """Along u, slope"""
    v: NotRequired[Union["Profile", None]]
    """Along v"""
    x: "Profile"
    """Along x, metres"""
    y: NotRequired[Union["Profile", None]]
    """Along y"""

AxisName = Union[Literal["X"], Literal["Y"]]
"""An axis across the central ray."""

Blockers = Union["BlockersJitteredSquares", "BlockersShapes", "BlockersGrating", "BlockersMesh"]
"""Black blockers, most of them in one plane orthogonal to the central ray."""

Bulb = Union["BulbSquare", "BulbDisc"]
"""The bulb of a spot, orthogonal to the central ray."""

Emission = Union[Literal["Aimed"], Literal["Plain"]]
"""How photons leave the light."""

Environment = Union["EnvironmentLobes", "EnvironmentFile"]
"""Radiance by the direction light comes from; in coordinates whose second axis is `up` and whose third is `front`."""

Event = Union[Literal["Mirror"], "EventRefraction", "EventThinLens", "EventReflects", "EventSum"]
"""What a smooth surface does to light."""

Form = Union[Literal["Plane"], "FormSphere", "FormCylinder", "FormParaboloid"]
"""The form of a smooth surface around its vertex; curvatures per metre, positive if it is convex seen from where it faces."""

Fresnel = Union[Literal["White"], "FresnelDielectric", "FresnelConductor"]
"""The share of light that is reflected, by the angle of incidence."""

HalfName = Union[Literal["Below"], Literal["Above"]]
"""A side of a line."""

Light = Union["LightRectangle", "LightDisc", "LightPoint", "LightSpot", "LightProjector", "LightBeam", "LightEnvironment", "LightRays"]
"""The light. The central ray leaves its centre."""

Lobe = Union[Literal["Lambertian"], "LobePhong", "LobeBeckmann", "LobeGgx"]
"""The lobe of a BRDF."""

MeshSource = Union["MeshSourceFile", "MeshSourceParaboloid", "MeshSourceStar"]
"""Where a mesh comes from."""

Orientation = Union[Literal["Orthogonal"], Literal["Tangent"], Literal["LocalNormals"], Literal["Mirrored"]]
"""What the coordinates of a plane's rays are counted from.

On a surface, T is in the plane of incidence and B = N × T (docs/conventions.md); directions point away from the surface, those of
light that arrives being turned around. A direction is cos φ (sin θ T + cos θ N) + sin φ B: the plane-sphere parameterisation."""

Pattern = Union["PatternCosine", "PatternCheckerboard", "PatternPicture"]
"""A number from 0 to 1 at each place of a surface."""

Place = Union[Literal["Emission"], "PlaceBefore", "PlaceAfter", "PlaceDistance"]
"""A place on the path."""

Profile = Union["ProfileHann", "ProfileBox", "ProfileGaussian"]
"""One factor of a window: 1 at its centre, zero outside |t| < half-width."""

Quantity = Union[Literal["Radiance"], Literal["DifferentialIrradiance"]]
"""What a plane records."""

Sampling = Union[Literal["Net"], Literal["Random"]]
"""The numbers that photons are drawn from."""

Shape = Union["ShapeRectangle", "ShapeDisc", "ShapeHalfPlane"]
"""A shape in the plane of its blockers."""

Surface = Union["SurfaceRectangle", "SurfaceMesh", "SurfaceSmooth"]
"""What light falls on."""
