//! Checks virtual planes: their positions on the path, their windows and their frequencies.

use super::faults::{names, show};
use super::{PathStop, Resolver, SAME_PLANE};
use crate::scene::{CentralRay, Object};
use etendue_field::{
    Frame, FrequencyAxis, Orientation, Profile, Side, SliceGrid, VirtualPlane, Window, byte_size,
    tidy,
};
use etendue_scenefile::Fault;
use etendue_scenefile::did_you_mean;
use etendue_scenefile::limits;
use etendue_scenefile::{
    AxisFile, BlockersFile, FrequenciesFile, Place, PlaneFile, SceneFile, SurfaceFile, WindowFile,
};
use etendue_scenefile::{number, shown};

/// A position on the path.
#[derive(Clone, Copy)]
struct OnPath {
    distance: f64,
    side: Side,
    leg: usize,
}

/// Number of bytes of one complex number.
const COMPLEX: f64 = 16.0;
impl Resolver<'_> {
    pub(super) fn planes(
        &mut self,
        file: &SceneFile,
        path: &CentralRay,
        stops: &[PathStop<'_>],
    ) -> Vec<VirtualPlane> {
        if file.planes.is_empty() {
            self.faults.add("planes", "empty", "at least one plane");
        }
        let mut planes = Vec::new();
        for (i, plane) in file.planes.iter().enumerate() {
            let of = format!("planes[{i}]");
            let place = self.place(&format!("{of}.at"), &plane.at, file, path, stops);
            let window = match &plane.window {
                Some(window) => self.window(&format!("{of}.window"), window),
                None => self.window("window", &file.window),
            };
            let grid = match &plane.frequencies {
                Some(f) => self.frequencies(&format!("{of}.frequencies"), f, &window),
                None => self.frequencies("frequencies", &file.frequencies, &window),
            };
            let (Some(place), Some(grid)) = (place, grid) else {
                continue;
            };
            let (frame, longitude) = self.view(&of, plane, place, path, stops);
            planes.push(VirtualPlane {
                name: plane.name.clone(),
                distance: place.distance,
                leg: place.leg,
                side: place.side,
                quantity: plane.quantity,
                orientation: plane.orientation,
                longitude,
                frame: path.frame.compose(&frame),
                window,
                grid,
            });
        }
        planes
    }

    /// The frame of a plane, in the frame at the light, and the longitude of the central
    /// ray in the plane's frame.
    fn view(
        &mut self,
        of: &str,
        plane: &PlaneFile,
        place: OnPath,
        path: &CentralRay,
        stops: &[PathStop<'_>],
    ) -> (Frame, f64) {
        let across = (path.frame_at(place.distance, place.leg), 0.0);
        if plane.orientation == Orientation::Orthogonal {
            return across;
        }
        let of = format!("{of}.orientation");
        if plane.orientation == Orientation::Mirrored && place.side == Side::After {
            let allowed = "Mirrored, if the place is Before(…) a surface: light that has left a surface is not mirrored";
            self.faults.add(&of, show(plane.orientation), allowed);
        }
        let hit = match place.side {
            Side::Before => path.ends_at(place.leg).map(|hit| (hit, place.leg)),
            Side::After => path.legs[place.leg]
                .leaves
                .as_ref()
                .map(|hit| (hit, place.leg - 1)),
        };
        let at_hit = match &plane.at {
            Place::Before(name) | Place::After(name) => {
                let mut visited = stops.iter().filter(|stop| stop.ends.is_some());
                visited.any(|stop| stop.name == name)
            }
            Place::Emission | Place::Distance(_) => false,
        };
        let Some((hit, arriving)) = hit.filter(|_| at_hit) else {
            let allowed = "Orthogonal, or another orientation at a place Before(…) or After(…) a surface that the path visits";
            self.faults
                .add_on_path(&of, show(plane.orientation), allowed);
            return across;
        };
        let on_mesh = matches!(hit.object, Object::Mesh(_));
        if on_mesh && plane.orientation.is_local() {
            let allowed =
                "Orthogonal or Tangent: the normals of a mesh are known only between its vertices";
            self.faults.add(&of, show(plane.orientation), allowed);
        }
        let (frame, arrives) = hit.surface_frame(&path.legs[arriving].frame);
        match place.side {
            Side::Before if plane.orientation == Orientation::Mirrored => (frame, -arrives),
            Side::Before => (frame, arrives),
            Side::After => {
                let d = path.legs[place.leg].frame.d;
                // Transmitted light leaves on the other side of the surface, so N is reversed and
                // T is rotated with N.
                let frame = if d.dot(frame.d) < 0.0 {
                    Frame {
                        x: -frame.x,
                        d: -frame.d,
                        ..frame
                    }
                } else {
                    frame
                };
                (frame, frame.longitude(d))
            }
        }
    }

    fn place(
        &mut self,
        of: &str,
        place: &Place,
        file: &SceneFile,
        path: &CentralRay,
        stops: &[PathStop<'_>],
    ) -> Option<OnPath> {
        match place {
            Place::Emission => Some(OnPath {
                distance: 0.0,
                side: Side::After,
                leg: 0,
            }),
            Place::Before(name) => {
                let stop = self.stop(of, place, name, file, path, stops)?;
                Some(OnPath {
                    distance: match stop.ends {
                        Some(leg) => path.legs[leg + 1].start,
                        None => self.beyond_light(of, place, stop.extent[0]),
                    },
                    side: Side::Before,
                    leg: stop.ends.unwrap_or(0),
                })
            }
            Place::After(name) => {
                let stop = self.stop(of, place, name, file, path, stops)?;
                let visited = stop.ends.is_some() || file.path.visits.contains(name);
                if stop.surface && !visited {
                    let allowed = "After(…) with a surface that the path visits";
                    self.faults.add_on_path(of, show(place), allowed);
                }
                let leg = stop.ends.map_or(0, |leg| leg + 1);
                Some(OnPath {
                    distance: if leg > 0 {
                        path.legs[leg].start
                    } else {
                        self.beyond_light(of, place, stop.extent[1])
                    },
                    side: Side::After,
                    leg,
                })
            }
            Place::Distance(distance) => Some(self.at_distance(of, *distance, path, stops)),
        }
    }

    /// The object to which the position of a plane refers.
    fn stop<'a>(
        &mut self,
        of: &str,
        place: &Place,
        name: &str,
        file: &SceneFile,
        path: &CentralRay,
        stops: &'a [PathStop<'a>],
    ) -> Option<&'a PathStop<'a>> {
        let Some(stop) = stops.iter().find(|s| s.name == name) else {
            let surfaces = file.surfaces.iter().map(SurfaceFile::name);
            let mut written = file.blockers.iter().map(BlockersFile::name).chain(surfaces);
            // If the object is faulty, the fault has been reported already.
            if !written.clone().any(|written| written == name) {
                let value = show(place) + &did_you_mean(name, written.clone());
                let allowed = format!("one of {}", names(&mut written));
                self.faults.add(of, value, allowed);
            }
            return None;
        };
        let length = path.first_hit();
        if stop.ends.is_none() && stop.extent[0] > length {
            let allowed = format!(
                "a place on the path, whose first surface is at {} m",
                tidy(length)
            );
            self.faults.add_on_path(of, show(place), allowed);
        }
        Some(stop)
    }

    /// Checks that a position, given by its distance along the first leg, is not behind the
    /// light.
    fn beyond_light(&mut self, of: &str, place: &Place, distance: f64) -> f64 {
        if distance < 0.0 {
            let allowed = format!(
                "a place on the path, which begins at the light; this place lies {} m behind the light",
                tidy(-distance)
            );
            self.faults.add_on_path(of, show(place), allowed);
        }
        distance
    }

    /// The position on the path at a given distance, with the leg that contains it.
    fn at_distance(
        &mut self,
        of: &str,
        distance: f64,
        path: &CentralRay,
        stops: &[PathStop<'_>],
    ) -> OnPath {
        let value = || format!("Distance({})", number(distance));
        let leg = path.legs.iter().rposition(|leg| leg.start <= distance);
        let leg = leg.unwrap_or(0);
        let last = &path.legs[path.legs.len() - 1];
        let end = last.start + last.length;
        if !end.is_nan() && !(0.0..end).contains(&distance) {
            let allowed = format!(
                "0 m to the last surface at {} m, or from this surface to {} m, where an object ends the path",
                tidy(last.start),
                tidy(end)
            );
            self.faults.add_on_path(of, value(), allowed);
        }
        let ends = |leg: &usize| near(path.legs[leg + 1].start, distance);
        let hit = (0..path.legs.len() - 1).find(ends);
        let hit = hit.and_then(|leg| stops.iter().find(|s| s.ends == Some(leg)));
        let at = path.frame_at(distance, leg);
        let beside = |s: &&PathStop<'_>| s.extent.iter().any(|end| near(*end, at.origin.z));
        let on_first = || stops.iter().filter(|_| leg == 0).find(beside);
        if let Some(stop) = hit.or_else(on_first) {
            let name = shown(stop.name, limits::NAME);
            let allowed = format!("Before(\"{name}\") or After(\"{name}\") at that distance");
            self.faults.add_on_path(of, value(), allowed);
        } else if let Some(stop) = stops
            .iter()
            .filter(|stop| stop.is_flat() && is_across(&at))
            .find(beside)
        {
            // If the plane were at the object's distance, only rounding errors would determine
            // whether light on its way back crosses the plane before or after the object.
            let name = shown(stop.name, limits::NAME);
            let allowed = format!("a distance at which {name} does not lie in the plane");
            self.faults.add_on_path(of, value(), allowed);
        }
        OnPath {
            distance,
            side: Side::After,
            leg,
        }
    }

    fn window(&mut self, of: &str, window: &WindowFile) -> Window {
        let resolved = Window {
            x: window.x,
            y: window.y.unwrap_or(window.x),
            u: window.u,
            v: window.v.unwrap_or(window.u),
        };
        let profiles = [
            ("x", resolved.x),
            ("y", resolved.y),
            ("u", resolved.u),
            ("v", resolved.v),
        ];
        for (axis, profile) in profiles {
            let stated = (axis != "y" || window.y.is_some()) && (axis != "v" || window.v.is_some());
            if stated {
                self.profile(&format!("{of}.{axis}"), &profile);
            }
        }
        resolved
    }

    fn profile(&mut self, of: &str, profile: &Profile) {
        match *profile {
            Profile::Hann(_) | Profile::Box(_) => {}
            Profile::Gaussian { width, cut } => {
                // A Gaussian profile ends at a half-width, the cut. A prediction sums a series, and
                // the number of its terms grows with the cut.
                if width.is_finite() && cut.is_finite() && cut > 10.0 * width {
                    let allowed =
                        "at most 10 widths: beyond 3.5 widths the Gaussian is below 1e-16";
                    self.faults.add(format!("{of}.cut"), number(cut), allowed);
                }
            }
        }
    }

    fn frequencies(
        &mut self,
        of: &str,
        file: &FrequenciesFile,
        window: &Window,
    ) -> Option<SliceGrid> {
        let half_x = window.x.half_width().max(window.y.half_width());
        let half_u = window.u.half_width().max(window.v.half_width());
        let rho = self.axis(&format!("{of}.rho"), &file.rho, half_x);
        let nu = self.axis(&format!("{of}.nu"), &file.nu, half_u);
        Some(SliceGrid {
            azimuths: file.azimuths as usize,
            rho: rho?,
            nu: nu?,
        })
    }

    fn axis(&mut self, of: &str, axis: &AxisFile, half_width: f64) -> Option<FrequencyAxis> {
        let natural = 0.5 / half_width;
        let spacing = axis.spacing.unwrap_or(natural);
        if axis.spacing.is_some() {
            // If the width of a window is zero, the fault has been reported already.
            if natural > 0.0 && spacing > natural * (1.0 + SAME_PLANE) {
                let natural = tidy(natural);
                let allowed = format!("at most 1/(2 · half-width of the window) = {natural}");
                self.faults
                    .add(format!("{of}.spacing"), number(spacing), allowed);
            }
        }
        // If max is a multiple of the spacing, rounding must not add a frequency.
        let half = (axis.max / spacing - 1e-9).ceil();
        if !half.is_finite() || half < 1.0 {
            return None;
        }
        if half > f64::from(u32::MAX) {
            self.faults.add(
                format!("{of}.max"),
                format!("{} spacings of {}", number(half), number(spacing)),
                "fewer than 2^32 frequencies",
            );
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the number was checked to be in 1..2^32"
        )]
        let half = half as usize;
        Some(FrequencyAxis { half, spacing })
    }

    /// Checks that the spectra of all batches fit in memory, because all spectra are kept until
    /// the errors are known.
    pub(super) fn memory(&mut self, planes: &[VirtualPlane], batches: u32) {
        let memory = self.memory;
        let cells =
            |grid: &SliceGrid| -> f64 { grid.half_shape().iter().map(|n| *n as f64).product() };
        // Memory holds the spectra of all batches and their residuals. A hundred further copies of
        // the spectra suffice for the rest. The rest is the prediction, its derivatives and errors,
        // and seven fine grids of the transform on each of a dozen threads.
        let copies = 2.0 * f64::from(batches) + 100.0;
        let bytes: f64 = planes
            .iter()
            .map(|p| cells(&p.grid) * COMPLEX * copies)
            .sum();
        if bytes > memory as f64 {
            self.faults.all.push(Fault {
                field: "frequencies of all planes".to_owned(),
                value: format!("{} for the spectra of {batches} batches", byte_size(bytes)),
                allowed: format!(
                    "at most the available memory, {}: use lower frequencies, a smaller window, or lengths in metres",
                    byte_size(memory as f64)
                ),
                memory: true,
            });
        }
    }
}

/// Checks whether a frame lies across the first leg.
fn is_across(frame: &Frame) -> bool {
    libm::hypot(frame.d.x, frame.d.y) <= SAME_PLANE
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_PLANE * a.abs()
}
