//! Cameras of a world, and the rays of their pixels.

use glam::{DAffine3, DMat3, DVec3};

/// A camera. `to_world` maps the camera's coordinates to the world. In these coordinates, the
/// camera looks along Z, Y points up in the picture, and X points to the left.
#[derive(Clone, Debug)]
pub struct Camera {
    /// The name of the camera in the file.
    pub name: String,
    /// The map from camera to world coordinates. It has no scale, except for orthographic cameras.
    pub to_world: DAffine3,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The projection.
    pub projection: Projection,
    /// The visible range along Z: its near and its far distance.
    pub clip: [f64; 2],
}

/// The projection of a camera.
#[derive(Clone, Copy, Debug)]
pub enum Projection {
    /// Rays from one point, or from a lens around it.
    Perspective {
        /// Half the width of the picture at z = 1.
        half_width: f64,
        /// The shift of the picture's centre to the right and down, in units of the picture's
        /// width and height.
        shift: [f64; 2],
        /// The lens; `None` for a pinhole.
        lens: Option<Lens>,
    },
    /// Parallel rays along Z that start at x from −1 to 1. The range of y is chosen so that pixels
    /// are square.
    Orthographic,
}

/// A thin lens in the plane z = 0.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    /// Radius of the lens.
    pub radius: f64,
    /// The z coordinate of the plane of focus.
    pub focus: f64,
}

/// A ray in the world.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Its origin.
    pub from: DVec3,
    /// The direction of the ray, of unit length.
    pub along: DVec3,
    /// The visible range of distances along the ray.
    pub seen: [f64; 2],
}

impl Camera {
    /// Creates a camera without a lens at the point `from`, with the point `at` in the middle of
    /// its picture, and `up` upwards in the picture. Returns `None` if these give no orientation.
    #[must_use]
    pub fn pinhole(
        [from, at, up]: [DVec3; 3],
        half_width: f64,
        size: [usize; 2],
        clip: [f64; 2],
    ) -> Option<Self> {
        let ahead = (at - from).try_normalize()?;
        let left = up.cross(ahead).try_normalize()?;
        let frame = DMat3::from_cols(left, ahead.cross(left), ahead);
        Some(Self {
            name: "camera".to_owned(),
            to_world: DAffine3::from_mat3_translation(frame, from),
            size,
            projection: Projection::Perspective {
                half_width,
                shift: [0.0; 2],
                lens: None,
            },
            clip,
        })
    }

    /// Whether rays begin at different points of a lens.
    #[must_use]
    pub fn has_lens(&self) -> bool {
        matches!(
            self.projection,
            Projection::Perspective { lens: Some(_), .. }
        )
    }

    /// The ray through a point of the picture and a point of the lens. The first is given
    /// in pixels to the right and down from the picture's top left, and the second by a point of
    /// the unit disc.
    #[inline]
    #[must_use]
    pub fn look(&self, [right, down]: [f64; 2], lens: [f64; 2]) -> Look {
        let [w, h] = self.size.map(|n| n as f64);
        let across = 1.0 - 2.0 * right / w;
        let up = (1.0 - 2.0 * down / h) * h / w;
        let (from, along) = match self.projection {
            Projection::Perspective {
                half_width,
                shift,
                lens: of,
            } => {
                let x = half_width * (across + 2.0 * shift[0]);
                let y = half_width * (up + 2.0 * shift[1] * h / w);
                let along = DVec3::new(x, y, 1.0);
                match of {
                    None => (DVec3::ZERO, along),
                    Some(Lens { radius, focus }) => {
                        let from = DVec3::new(radius * lens[0], radius * lens[1], 0.0);
                        (from, (focus * along - from) / focus)
                    }
                }
            }
            Projection::Orthographic => (DVec3::new(across, up, 0.0), DVec3::Z),
        };
        let world = self.to_world.transform_vector3(along);
        // Clip planes are perpendicular to Z, so an oblique ray reaches them later.
        let longer = along.length();
        Look {
            from: self.to_world.transform_point3(from),
            along: world.normalize(),
            seen: self.clip.map(|z| z * longer),
        }
    }
}
