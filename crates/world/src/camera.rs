//! Cameras of a world, and the rays of their pixels.

use glam::{DAffine3, DVec3};

/// What looks at a world. It looks along Z of `to_world`, Y is up in the picture and X to the left.
#[derive(Clone, Debug)]
pub struct Camera {
    /// What the file calls it.
    pub name: String,
    /// From coordinates of the camera to those of the world; without scale, but for orthographic cameras.
    pub to_world: DAffine3,
    /// Pixels across and down.
    pub size: [usize; 2],
    /// How rays leave it.
    pub projection: Projection,
    /// Nearer than this along Z nothing is seen, nor beyond the second.
    pub clip: [f64; 2],
}

/// How rays of a camera leave it.
#[derive(Clone, Copy, Debug)]
pub enum Projection {
    /// From one point, or from a lens about it.
    Perspective {
        /// Half the width of the picture at z = 1.
        half_width: f64,
        /// By how much of the picture's width and height its middle is moved to the right and down.
        shift: [f64; 2],
        /// `None` for a pinhole.
        lens: Option<Lens>,
    },
    /// All along Z, from x and y within ±1 across; as far down as pixels are square.
    Orthographic,
}

/// A thin lens in the plane z = 0.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    /// Of its disc.
    pub radius: f64,
    /// z of the plane that is in focus.
    pub focus: f64,
}

/// A ray in the world.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Where it begins.
    pub from: DVec3,
    /// Where it goes, of unit length.
    pub along: DVec3,
    /// Distances along it that are seen.
    pub seen: [f64; 2],
}

impl Camera {
    /// The ray through a place of the picture, counted in pixels to the right and down from its top left, and a point of the lens in the unit disc.
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
        // Clip planes are across Z: a ray at an angle reaches them later.
        let longer = along.length();
        Look {
            from: self.to_world.transform_point3(from),
            along: world.normalize(),
            seen: self.clip.map(|z| z * longer),
        }
    }
}
