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
    """Spacing of the frequencies. The default, 1/(2 · half-width of the window), is also the largest allowed. 1e-9 to 1e9"""


class BlockersAperture(TypedDict):
    """An opaque screen over the whole plane, with one hole."""

    Aperture: "BlockersApertureFields"


class BlockersApertureFields(TypedDict):
    center: Sequence[float]
    """Origin of the hole's X and Y coordinates, in world coordinates"""
    hole: "Hole"
    """The hole; light passes only through it"""
    name: str
    """Name"""


class BlockersBars(TypedDict):
    """Opaque bars with equal spacing. Each bar ends 10⁹ m from the central ray on either side."""

    Bars: "BlockersBarsFields"


class BlockersBarsFields(TypedDict):
    axis: "AxisName"
    """The axis across the bars"""
    center: Sequence[float]
    """Centre of the bars, in world coordinates"""
    count: int
    """Number of bars. 1 to 100000"""
    fill: float
    """Width of a bar as a share of the pitch. 1e-9 to 1"""
    name: str
    """Name"""
    pitch: float
    """Distance between the centres of neighbouring bars. 1e-9 to 1e9"""


class BlockersGrating(TypedDict):
    """A semi-transparent cosine grating over the whole plane: ½ (1 + m cos(2π f t + p)), where t is x or y."""

    Grating: "BlockersGratingFields"


class BlockersGratingFields(TypedDict):
    axis: "AxisName"
    """The axis along which the grating varies"""
    center: Sequence[float]
    """Origin of t, in world coordinates"""
    frequency: float
    """Frequency f, in cycles per metre. 1e-9 to 1e9"""
    modulation: NotRequired[float]
    """Modulation m. 0 to 1"""
    name: str
    """Name"""
    phase: NotRequired[float]
    """Phase p, in radians. -1000 to 1000"""


class BlockersJitteredSquares(TypedDict):
    """`count[0]` × `count[1]` squares on a jittered grid, with edges along X and Y."""

    JitteredSquares: "BlockersJitteredSquaresFields"


class BlockersJitteredSquaresFields(TypedDict):
    center: Sequence[float]
    """Centre of the grid, in world coordinates"""
    count: Sequence[int]
    """Number of squares along X and along Y"""
    fill: float
    """Side of a square as a share of the pitch. above 0, at most 1"""
    jitter: NotRequired[float]
    """Amount of jitter: each square is moved along X and along Y by a random number of pitches, uniform in (−jitter/2, jitter/2). 0 to 1 − fill"""
    name: str
    """Name by which planes refer to the blockers"""
    pitch: float
    """Distance between grid points. 1e-9 to 1e9"""
    seed: NotRequired[int]
    """Seed of the jitter. 0 to 2^64 − 1"""


class BlockersMesh(TypedDict):
    """An opaque triangle mesh, anywhere between the light and the end of the path."""

    Mesh: "BlockersMeshFields"


class BlockersMeshFields(TypedDict):
    center: Sequence[float]
    """Position of the mesh's origin, in world coordinates"""
    mesh: "MeshSource"
    """The triangles"""
    name: str
    """Name"""
    scale: NotRequired[float]
    """Scale factor of the mesh's coordinates. 1e-9 to 1e9"""


class BlockersPicture(TypedDict):
    """Opaque pixels of a picture: a pixel is opaque if its value, or the luminance or selected channel of its colour, is below 0.5; alpha is ignored. The levels of a PNG file count as they are stored, without the transfer curve of sRGB. X points to the right of the picture and Y to its top; outside, all is clear."""

    Picture: "BlockersPictureFields"


class BlockersPictureFields(TypedDict):
    center: Sequence[float]
    """Centre of the picture, in world coordinates"""
    file: str
    """An OpenEXR or PNG file of numbers from 0 to 1; the path is relative to the scene file, and must stay inside its folder"""
    name: str
    """Name"""
    size: Sequence[float]
    """Width along X and height along Y, in metres"""


class BlockersShapes(TypedDict):
    """Individual opaque shapes, which must not overlap."""

    Shapes: "BlockersShapesFields"


class BlockersShapesFields(TypedDict):
    center: Sequence[float]
    """Origin of the shapes' X and Y coordinates, in world coordinates"""
    name: str
    """Name"""
    shapes: Sequence["Shape"]
    """The shapes"""


class Brdf(TypedDict):
    """A BRDF."""

    albedo: NotRequired[Union[float, Sequence[float]]]
    """Factor that multiplies the lobe, 0 to 1. 0 to 1"""
    fresnel: NotRequired["Fresnel"]
    """Fresnel factor"""
    incoming: NotRequired[Union[Sequence[float], None]]
    """Factor that depends on the angle of incidence. Its values, at equal steps from the normal to 90 degrees, are interpolated linearly; 1 by default"""
    lobe: "Lobe"
    """Lobe of the BRDF"""
    outgoing: NotRequired[Union[Sequence[float], None]]
    """Factor that depends on the angle of the outgoing light, in the same form"""


class BulbDisc(TypedDict):
    """A disc with this radius."""

    Disc: float
    """1e-9 to 1e9"""


class BulbSquare(TypedDict):
    """A square with this side length and edges along X and Y."""

    Square: float
    """1e-9 to 1e9"""


class EnvironmentFile(TypedDict):
    """An OpenEXR picture of the radiance, in W m⁻² sr⁻¹, over latitude and longitude; the path is relative to the scene file, and must stay inside its folder."""

    File: str


class EnvironmentLobes(TypedDict):
    """A sum of lobes."""

    Lobes: Sequence["LightLobe"]


class EventReflects(TypedDict):
    """Reflects by a BRDF on the side that the surface faces; the other side is black."""

    Reflects: "EventReflectsFields"


class EventReflectsFields(TypedDict):
    blend: NotRequired[Union["Pattern", None]]
    """Weight of the first BRDF if there is a second BRDF"""
    brdf: "Brdf"
    """The BRDF"""
    other: NotRequired[Union["Brdf", None]]
    """A second BRDF that is added, weighted by 1 − `blend`"""
    texture: NotRequired[Union["Pattern", None]]
    """Factor that multiplies the BRDF"""


class EventRefraction(TypedDict):
    """Transmits light by Snell's law; nothing is reflected."""

    Refraction: "EventRefractionFields"


class EventRefractionFields(TypedDict):
    back: float
    """Index of refraction on the other side. 0.1 to 10"""
    front: float
    """Index of refraction on the side that the surface faces. 0.1 to 10"""


class EventSum(TypedDict):
    """Reflects by a weighted sum of BRDFs on the side that the surface faces; the other side is black."""

    Sum: "EventSumFields"


class EventSumFields(TypedDict):
    terms: Sequence["Term"]
    """1 to 8 BRDFs with their weights. If the path does not set the direction in which the central ray leaves, the first BRDF determines it"""
    texture: NotRequired[Union["Pattern", None]]
    """Factor that multiplies the sum"""


class EventThinLens(TypedDict):
    """A flat thin lens with this focal length."""

    ThinLens: float
    """a focal length in metres, other than 0, and negative if the lens spreads light"""


class FormCylinder(TypedDict):
    """A circular cylinder with this curvature, whose axis is orthogonal to `along`."""

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
    """Angular frequency ν, in cycles per unit slope"""
    rho: "Axis"
    """Spatial frequency ρ, in cycles per metre"""


class FresnelConductor(TypedDict):
    """Reflection at a conductor with index n + i k."""

    Conductor: "FresnelConductorFields"


class FresnelConductorFields(TypedDict):
    k: Union[float, Sequence[float]]
    """Index of absorption k. 0 to 20"""
    n: Union[float, Sequence[float]]
    """Index of refraction n. 0.05 to 20"""


class FresnelDielectric(TypedDict):
    """Reflection at a dielectric with this index of refraction."""

    Dielectric: float
    """0.05 to 20"""


class Grating(TypedDict):
    """The grating of a picture or a pattern."""

    axis: "AxisName"
    """The axis along which the grating varies"""
    frequency: float
    """Frequency f, in cycles per unit of the picture, or per metre of a surface. 1e-9 to 1e9"""
    modulation: NotRequired[float]
    """Modulation m. 0 to 1"""
    phase: NotRequired[float]
    """Phase p, in radians. -1e9 to 1e9"""


class HoleDisc(TypedDict):
    """A disc."""

    Disc: "HoleDiscFields"


class HoleDiscFields(TypedDict):
    center: Sequence[float]
    """Centre along X and Y"""
    radius: float
    """Radius. 1e-9 to 1e9"""


class HolePolygon(TypedDict):
    """A convex polygon."""

    Polygon: "HolePolygonFieldscorners"


class HolePolygonFieldscorners(TypedDict):
    corners: Sequence[Sequence[float]]
    """The 3 to 32 corners along X and Y, in order around the polygon"""


class HoleRectangle(TypedDict):
    """A rectangle with edges along X and Y."""

    Rectangle: "HoleRectangleFields"


class HoleRectangleFields(TypedDict):
    center: Sequence[float]
    """Centre along X and Y"""
    size: Sequence[float]
    """Side lengths along X and Y"""


class Image(TypedDict):
    """A smooth picture: exp(−π (a²/w₁² + b²/w₂²)), optionally times a grating ½ (1 + m cos(2π f t + p)). It is 0 beyond 3.6 widths, where the exponential is 2·10⁻¹⁸."""

    grating: NotRequired[Union["Grating", None]]
    """Grating of the picture"""
    width: Sequence[float]
    """Widths w₁ and w₂ along X and along Y"""


class LightBeam(TypedDict):
    """A collimated beam along the central ray whose irradiance is a picture."""

    Beam: "LightBeamFields"


class LightBeamFields(TypedDict):
    center: Sequence[float]
    """Start of the central ray, in world coordinates"""
    image: "Image"
    """The picture, in metres along X and along Y"""
    irradiance: NotRequired[Union[float, Sequence[float]]]
    """Irradiance, in W m⁻², where the picture has the value 1. 1e-9 to 1e9"""


class LightDisc(TypedDict):
    """A Lambertian disc orthogonal to the central ray, with a dark back."""

    Disc: "LightDiscFields"


class LightDiscFields(TypedDict):
    center: Sequence[float]
    """Centre, in world coordinates"""
    radiance: NotRequired[Union[float, Sequence[float]]]
    """Radiance, in W m⁻² sr⁻¹. 1e-9 to 1e9"""
    radius: float
    """Radius. 1e-9 to 1e9"""


class LightEnvironment(TypedDict):
    """Light from an environment. It starts in a plane that contains the centre and is orthogonal to `path.direction`, and it only travels forward from there."""

    Environment: "LightEnvironmentFields"


class LightEnvironmentFields(TypedDict):
    center: Sequence[float]
    """Start of the central ray, in world coordinates"""
    front: NotRequired[Sequence[float]]
    """Direction, of any length, of the middle of the map; only the part orthogonal to `up` is used"""
    map: "Environment"
    """Radiance by direction"""
    scale: NotRequired[float]
    """Scale factor of the map's radiance. 1e-9 to 1e9"""
    up: NotRequired[Sequence[float]]
    """Direction, of any length, of the top of the map"""


LightLobe = TypedDict("LightLobe", {"from": "Sequence[float]", "radiance": "NotRequired[Union[float, Sequence[float]]]", "width": "float"})


class LightPoint(TypedDict):
    """A point that emits uniformly in all directions ahead, along `path.direction`. No light goes back."""

    Point: "LightPointFields"


class LightPointFields(TypedDict):
    center: Sequence[float]
    """Position, in world coordinates"""
    intensity: NotRequired[Union[float, Sequence[float]]]
    """Intensity, in W sr⁻¹. 1e-9 to 1e9"""


class LightProjector(TypedDict):
    """A slide projector: a point whose intensity is a picture over slopes."""

    Projector: "LightProjectorFields"


class LightProjectorFields(TypedDict):
    center: Sequence[float]
    """Position, in world coordinates"""
    image: "Image"
    """The picture, over slopes along X and along Y"""
    intensity: NotRequired[Union[float, Sequence[float]]]
    """Intensity, in W sr⁻¹, where the picture has the value 1. 1e-9 to 1e9"""


class LightRays(TypedDict):
    """The rays of a file. They start where they cross the plane through the centre that is perpendicular to `path.direction`; rays that go backwards are omitted."""

    Rays: "LightRaysFields"


class LightRaysFields(TypedDict):
    center: Sequence[float]
    """Position of the file's origin and start of the central ray, in world coordinates"""
    file: str
    """IES TM-25, MCPL or NPY file; the path is relative to the scene file, and must stay inside its folder"""
    flux: NotRequired[Union[float, None]]
    """Flux of all rays of the file, in W. By default, the flux that the file states. This flux must be in W, or in lm if the file states the total flux in both W and lm. 1e-9 to 1e9"""
    front: NotRequired[Union[Sequence[float], None]]
    """Direction, of any length, of the file's Z axis; by default, `path.direction`"""
    up: NotRequired[Union[Sequence[float], None]]
    """Direction, of any length, of the file's Y axis; only the part orthogonal to `front` is used. By default, the Y axis of the central ray's frame"""


class LightRectangle(TypedDict):
    """A Lambertian rectangle orthogonal to the central ray, with edges along X and Y and a dark back."""

    Rectangle: "LightRectangleFields"


class LightRectangleFields(TypedDict):
    center: Sequence[float]
    """Centre, in world coordinates"""
    radiance: NotRequired[Union[float, Sequence[float]]]
    """Radiance, in W m⁻² sr⁻¹. 1e-9 to 1e9"""
    size: Sequence[float]
    """Side lengths along X and Y"""


class LightSpot(TypedDict):
    """A flat bulb whose radiance falls off as cosⁿθ, where θ is the angle to the central ray."""

    Spot: "LightSpotFields"


class LightSpotFields(TypedDict):
    bulb: "Bulb"
    """Shape of the bulb"""
    center: Sequence[float]
    """Centre, in world coordinates"""
    exponent: float
    """The exponent n. 0 to 10000"""
    radiance: NotRequired[Union[float, Sequence[float]]]
    """Radiance along the central ray, in W m⁻² sr⁻¹. 1e-9 to 1e9"""


class LobeBeckmann(TypedDict):
    """Microfacets with Beckmann's distribution of normals, with this roughness α."""

    Beckmann: float
    """0.001 to 1"""


class LobeGgx(TypedDict):
    """Microfacets with the GGX distribution, with this roughness α."""

    Ggx: float
    """0.001 to 1"""


class LobePhong(TypedDict):
    """Phong lobe: cosⁿ of the angle to the mirror direction, with this exponent n."""

    Phong: float
    """0 to 10000"""


class MeshSourceFile(TypedDict):
    """An OBJ or PLY file; the path is relative to the scene file, and must stay inside its folder."""

    File: str


class MeshSourceParaboloid(TypedDict):
    """A generated piece of the paraboloid z = −(k₁ x² + k₂ y²)/2 around the origin, facing along z."""

    Paraboloid: "MeshSourceParaboloidFields"


class MeshSourceParaboloidFields(TypedDict):
    cells: int
    """Number of cells along a side; each cell consists of two triangles. 1 to 2048"""
    curvatures: Sequence[float]
    """Curvatures k₁ and k₂ per metre, positive if convex"""
    half: float
    """Half-width: the piece extends from −half to half along x and along y. 1e-9 to 1e8"""


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
    """Number of rings from pole to pole. 2 to 2048"""


class Path(TypedDict):
    """The central ray. It leaves the light's centre and travels from surface to surface; each surface sends it towards the centre of the next."""

    direction: Sequence[float]
    """Direction, of any length, in which the ray leaves the light"""
    leaves: NotRequired[Union[Sequence[float], None]]
    """Direction, of any length, in which the ray leaves the last surface; by default, straight back"""
    visits: Sequence[str]
    """Names of the surfaces that the ray visits, in the order in which it visits them"""
    x_axis: Sequence[float]
    """The X axis; only the part orthogonal to the direction is used"""


class PatternCheckerboard(TypedDict):
    """A checkerboard of the values 1 and 0 with this period, which is twice the side of a square."""

    Checkerboard: float
    """1e-9 to 1e9"""


class PatternCosine(TypedDict):
    """½ (1 + m cos(2π f t + p)), where t is measured along `along` or orthogonal to it."""

    Cosine: "PatternCosineFields"


class PatternCosineFields(TypedDict):
    axis: "AxisName"
    """The axis along which the pattern varies; X is `along`"""
    frequency: float
    """Frequency f, in cycles per metre. 1e-9 to 1e9"""
    modulation: NotRequired[float]
    """Modulation m. 0 to 1"""
    phase: NotRequired[float]
    """Phase p, in radians. -1e9 to 1e9"""


class PatternPicture(TypedDict):
    """A picture centred on the vertex, with the value 0 outside. The levels of a PNG file count as they are stored, without the transfer curve of sRGB. X points to its right and Y to its top, as seen from the side that the surface faces."""

    Picture: "PatternPictureFields"


class PatternPictureFields(TypedDict):
    file: str
    """An OpenEXR or PNG file of numbers from 0 to 1; the path is relative to the scene file, and must stay inside its folder"""
    size: Sequence[float]
    """Width along X and height along Y, in metres"""


class PlaceAfter(TypedDict):
    """In the plane of these blockers or this surface; records the light that has passed the blockers or leaves the surface."""

    After: str


class PlaceBefore(TypedDict):
    """In the plane of these blockers or this surface; records the light that arrives there."""

    Before: str


class PlaceDistance(TypedDict):
    """At this distance from the light, along the path."""

    Distance: float
    """0 to the end of the path"""


class Plane(TypedDict):
    """A virtual plane."""

    at: "Place"
    """Place on the path"""
    frequencies: NotRequired[Union["Frequencies", None]]
    """The plane's own frequencies"""
    name: str
    """Name of the plane, and of the folder of its results"""
    orientation: NotRequired["Orientation"]
    """Reference frame of the plane's coordinates"""
    quantity: NotRequired["Quantity"]
    """What the plane records"""
    window: NotRequired[Union["Window", None]]
    """The plane's own window"""


class ProfileBox(TypedDict):
    """Box: 1 on |t| < h."""

    Box: float
    """1e-9 to 1e9"""


class ProfileGaussian(TypedDict):
    """Truncated Gaussian: exp(−π t² / width²) on |t| < cut."""

    Gaussian: "ProfileGaussianFields"


class ProfileGaussianFields(TypedDict):
    cut: float
    """Half-width of the support. 1e-9 to 1e9"""
    width: float
    """The width, which is the integral of the Gaussian before truncation. 1e-9 to 1e9"""


class ProfileHann(TypedDict):
    """Hann window: cos²(π t / 2h) on |t| < h."""

    Hann: float
    """1e-9 to 1e9"""


class Run(TypedDict):
    """The settings of the measurement."""

    alpha: NotRequired[float]
    """Probability that the verdict rejects a correct scene, for all planes together. 1e-6 to 0.5"""
    batches: NotRequired[int]
    """Number of independent batches, from which errors are estimated. 32 to 1024: errors are estimated from the spread between batches"""
    color: NotRequired["Color"]
    """The number of each colour that is measured. Runs that differ only in it trace the same photons if there is one light, and it is no environment"""
    emission: NotRequired["Emission"]
    """How photons leave the light"""
    photons: NotRequired[int]
    """Number of emitted photons, which may be written as 1e7. at least one for each batch, at most 10^12"""
    resolution: NotRequired[float]
    """Largest noise, as a share of the spectrum, with which a plane passes. 0.0001 to 1"""
    sampling: NotRequired["Sampling"]
    """The random numbers from which photons are drawn"""
    seed: NotRequired[int]
    """Seed of the photons. 0 to 2^64 − 1"""


class Scene(TypedDict):
    """A scene file as a tree."""

    as_printed: NotRequired[bool]
    """Whether geometric steps are predicted by the paper's equations as printed (9, 10, 11 and 19)"""
    blockers: NotRequired[Sequence["Blockers"]]
    """The blockers"""
    description: NotRequired[str]
    """A description of the scene for the reader"""
    format: NotRequired[int]
    """The number of the format of this file. It stands first, so that a version that does not know the format says so. 1 to 1"""
    frequencies: "Frequencies"
    """The frequencies of every plane that has no frequencies of its own"""
    light: "Light"
    """The light source"""
    other_lights: NotRequired[Sequence["Light"]]
    """Further lights. Their light adds to that of `light`, and all lights shine along the central ray. Only a `Rectangle`, a `Disc` or a `Spot` may stand beside the central ray"""
    path: "Path"
    """The central ray"""
    planes: Sequence["Plane"]
    """The virtual planes"""
    run: NotRequired["Run"]
    """The settings of the measurement"""
    surfaces: NotRequired[Sequence["Surface"]]
    """The surfaces"""
    window: "Window"
    """The window of every plane that has no window of its own"""


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
    """A rectangle with edges along X and Y."""

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
    albedo: NotRequired[Union[float, Sequence[float]]]
    """Albedo (the ratio of reflected to incident flux), if the mesh is Lambertian. 0 to 1"""
    center: Sequence[float]
    """Position of the mesh's origin, in world coordinates"""
    event: NotRequired[Union["Event", None]]
    """Interaction with light as a smooth surface, with normals interpolated between vertices"""
    mesh: "MeshSource"
    """The triangles"""
    name: str
    """Name"""
    scale: NotRequired[float]
    """Scale factor of the mesh's coordinates. 1e-9 to 1e9"""


class SurfaceRectangle(TypedDict):
    """A Lambertian rectangle, with edges along X and Y by default. For a mirror or a glossy surface, use `Smooth` with `form: Plane`."""

    Rectangle: "SurfaceRectangleFields"


class SurfaceRectangleFields(TypedDict):
    albedo: NotRequired[Union[float, Sequence[float]]]
    """Albedo: the ratio of reflected to incident flux. 0 to 1"""
    center: Sequence[float]
    """Centre, in world coordinates"""
    facing: NotRequired[Union[Sequence[float], None]]
    """Normal of the rectangle, of any length; by default, opposite to `path.direction`. One pair of edges is along the part of the path's X axis that is orthogonal to the normal; if X is along the normal, the Y axis is used. The other pair is orthogonal to the first"""
    name: str
    """Name by which the path and the planes refer to the surface"""
    size: Sequence[float]
    """Side lengths along X and Y"""


class SurfaceSmooth(TypedDict):
    """A smooth piece of a plane, sphere, cylinder or paraboloid that reflects or refracts."""

    Smooth: "SurfaceSmoothFields"


class SurfaceSmoothFields(TypedDict):
    along: NotRequired[Union[Sequence[float], None]]
    """Direction, of any length, of the first curvature; by default, the path's X axis (or Y, if the surface faces along X). Only the part orthogonal to the normal is used"""
    aperture: float
    """Radius of the surface, seen along the normal. 1e-9 to 1e9"""
    center: Sequence[float]
    """Vertex of the surface, in world coordinates"""
    event: "Event"
    """Interaction with light"""
    facing: Sequence[float]
    """Normal at the vertex, of any length"""
    form: "Form"
    """Shape of the surface"""
    name: str
    """Name"""


class Term(TypedDict):
    """A term in a sum of BRDFs."""

    brdf: "Brdf"
    """The BRDF"""
    weight: NotRequired[Union["Pattern", None]]
    """Weight of the BRDF at each place; 1 by default"""


class Window(TypedDict):
    """The window, with a profile for each coordinate. By default, y has the profile of x, and v has the profile of u."""

    u: "Profile"
    """Profile along the slope u"""
    v: NotRequired[Union["Profile", None]]
    """Profile along the slope v"""
    x: "Profile"
    """Profile along x, in metres"""
    y: NotRequired[Union["Profile", None]]
    """Profile along y"""

AxisName = Union[Literal["X"], Literal["Y"]]
"""An axis orthogonal to the central ray."""

Blockers = Union["BlockersJitteredSquares", "BlockersBars", "BlockersPicture", "BlockersShapes", "BlockersAperture", "BlockersGrating", "BlockersMesh"]
"""Black blockers. Each group except a mesh lies in one plane orthogonal to the central ray."""

Bulb = Union["BulbSquare", "BulbDisc"]
"""The flat bulb of a spot. The bulb is orthogonal to the central ray."""

Color = Union[Literal["Luminance"], Literal["Red"], Literal["Green"], Literal["Blue"]]
"""The number of each colour that is measured. Colours are linear sRGB."""

Emission = Union[Literal["Aimed"], Literal["Plain"]]
"""How photons leave the light."""

Environment = Union["EnvironmentLobes", "EnvironmentFile"]
"""Radiance by the direction from which light comes, in coordinates whose second axis is `up` and whose third is `front`."""

Event = Union[Literal["Mirror"], "EventRefraction", "EventThinLens", "EventReflects", "EventSum"]
"""The interaction of a smooth surface with light."""

Form = Union[Literal["Plane"], "FormSphere", "FormCylinder", "FormParaboloid"]
"""The shape of a smooth surface around its vertex. Curvatures are per metre, and positive if the surface is convex as seen from the side that it faces."""

Fresnel = Union[Literal["White"], "FresnelDielectric", "FresnelConductor"]
"""The share of light that is reflected, as a function of the angle of incidence."""

HalfName = Union[Literal["Below"], Literal["Above"]]
"""A side of a line."""

Hole = Union["HoleDisc", "HoleRectangle", "HolePolygon"]
"""The hole of an aperture."""

Light = Union["LightRectangle", "LightDisc", "LightPoint", "LightSpot", "LightProjector", "LightBeam", "LightEnvironment", "LightRays"]
"""The light; the central ray starts at its centre."""

Lobe = Union[Literal["Lambertian"], "LobePhong", "LobeBeckmann", "LobeGgx"]
"""The lobe of a BRDF."""

MeshSource = Union["MeshSourceFile", "MeshSourceParaboloid", "MeshSourceStar"]
"""The source of a mesh."""

Orientation = Union[Literal["Orthogonal"], Literal["Tangent"], Literal["LocalNormals"], Literal["Mirrored"]]
"""The reference for the coordinates of a plane's rays.  On a surface, T is in the plane of incidence and B = N × T (docs/conventions.md). Directions point away from the surface, so the directions of arriving light are reversed. A direction has the form cos φ (sin θ T + cos θ N) + sin φ B, which is the plane-sphere parameterisation. The coordinates of a ray are its position along T and B, θ − θ₁ and φ, where θ₁ is the θ of the central ray; the window and the spectrum are those of θ − θ₁ and φ."""

Pattern = Union["PatternCosine", "PatternCheckerboard", "PatternPicture"]
"""A number from 0 to 1 at each place of a surface."""

Place = Union[Literal["Emission"], "PlaceBefore", "PlaceAfter", "PlaceDistance"]
"""A place on the path."""

Profile = Union["ProfileHann", "ProfileBox", "ProfileGaussian"]
"""One factor of a window. The factor is 1 at its centre and zero outside |t| < half-width."""

Quantity = Union[Literal["Radiance"], Literal["DifferentialIrradiance"]]
"""The quantity that a plane records."""

Sampling = Union[Literal["Lattice"], Literal["Net"], Literal["Random"]]
"""The random numbers from which photons are drawn."""

Shape = Union["ShapeRectangle", "ShapeDisc", "ShapeHalfPlane"]
"""An opaque shape in the plane of a group of blockers."""

Surface = Union["SurfaceRectangle", "SurfaceMesh", "SurfaceSmooth"]
"""A surface that light falls on."""
