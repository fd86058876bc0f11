//! Checks the smooth surfaces of a scene file.

use super::Resolver;
use super::faults::{show, vector};
use crate::scene::{Event, PatchObject};
use etendue_field::{Frame, Patch, Specular, tidy};
use etendue_scenefile::number;
use etendue_scenefile::{EventFile, FormFile, SceneFile, SurfaceFile};
use glam::DVec3;

impl Resolver<'_> {
    /// The smooth surfaces.
    pub(super) fn patches(&mut self, file: &SceneFile, light: &Frame) -> Vec<PatchObject> {
        let surfaces = file.surfaces.iter().enumerate();
        surfaces
            .filter_map(|(i, surface)| self.patch(&format!("surfaces[{i}]"), surface, light))
            .collect()
    }

    #[expect(
        clippy::too_many_lines,
        reason = "the function has a case for each form and event"
    )]
    fn patch(&mut self, of: &str, surface: &SurfaceFile, light: &Frame) -> Option<PatchObject> {
        let SurfaceFile::Smooth {
            name,
            center,
            facing,
            form,
            along,
            aperture,
            event,
        } = surface
        else {
            return None;
        };
        let curvature = match *form {
            FormFile::Plane => [0.0; 3],
            FormFile::Sphere(k) => [k; 3],
            FormFile::Cylinder(k) => [k, 0.0, k],
            FormFile::Paraboloid(k, l) => [k, l, 0.0],
        };
        // Only the half of a sphere or a cylinder that contains the vertex is used.
        if curvature[2] != 0.0 && *aperture > 1.0 / curvature[2].abs() {
            let allowed = format!(
                "at most the radius of curvature, {} m",
                tidy(1.0 / curvature[2].abs())
            );
            self.faults
                .add(format!("{of}.aperture"), number(*aperture), allowed);
        }
        let of_event = format!("{of}.event");
        let event = match event {
            EventFile::Reflects { .. } | EventFile::Sum { .. } => {
                Event::Reflects(self.reflectance(&of_event, event)?)
            }
            _ => Event::Specular(self.specular(&of_event, event, *form)?),
        };
        let origin = light.to_local(DVec3::from(*center));
        let d = light.vector_to_local(DVec3::from(*facing));
        let frame = match along {
            Some(along) => Frame::new(origin, d, light.vector_to_local(DVec3::from(*along))),
            None => Frame::new(origin, d, DVec3::X).or_else(|| Frame::new(origin, d, DVec3::Y)),
        };
        if frame.is_none() && d.is_finite() {
            match along {
                Some(along) if DVec3::from(*along) == DVec3::ZERO => {
                    let allowed = "a direction";
                    self.faults
                        .add(format!("{of}.along"), vector(along), allowed);
                }
                _ => {
                    let allowed = "a direction that is not parallel to `along`";
                    let field = format!("{of}.facing");
                    self.faults.add(field, vector(facing), allowed);
                }
            }
        }
        Some(PatchObject {
            name: name.clone(),
            patch: Patch {
                frame: frame?,
                curvature,
                aperture: *aperture,
            },
            event,
        })
    }

    /// The specular event of a surface; `None` if the surface reflects by a BRDF.
    pub(super) fn specular(
        &mut self,
        of: &str,
        event: &EventFile,
        form: FormFile,
    ) -> Option<Specular> {
        Some(match *event {
            EventFile::Reflects { .. } | EventFile::Sum { .. } => return None,
            EventFile::Mirror => Specular::Mirror,
            EventFile::Refraction { front, back } => Specular::Refraction { front, back },
            EventFile::ThinLens(focal_length) => {
                if focal_length == 0.0 || !focal_length.is_finite() {
                    let allowed = "a focal length in metres, other than 0, and negative if the lens spreads light";
                    self.faults.add(of, show(event), allowed);
                }
                if form != FormFile::Plane {
                    self.faults.add(
                        of,
                        show(event),
                        "ThinLens(…) on a Plane: a thin lens has no curvature",
                    );
                }
                Specular::ThinLens { focal_length }
            }
        })
    }
}
