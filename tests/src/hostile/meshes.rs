//! Mutated mesh files, used as a blocker and as a curved mirror. The formats are OBJ, and PLY as
//! text and as binary in both byte orders.

use super::case::Attack;
use super::dice::Dice;
use super::folder;
use super::scenes::{SCENE, on_scene};
use super::{bytes, text};
use etendue_meshfile::{Fault, Mesh};

/// Tokens of the formats OBJ and PLY.
const WORDS: &str = "v | f | vn | vt | l | p | o | g | usemtl | cstype | curv | -1 | 1/1/1 | // | \
    \\\n | \n | # | property | element | list | uchar | double | int | vertex | face | end_header";

/// A mesh as blocker, away from the centre of the light.
const BLOCKER: &str = r#"(
    light: Rectangle(center: (0, 0, 0), size: (0.2, 0.2)),
    blockers: [Mesh(name: "mesh", center: (0.05, 0, 1), mesh: File("NAME"), scale: 0.2)],
    surfaces: [Rectangle(name: "floor", center: (0, 0, 2), size: (6, 6))],
    path: (direction: (0, 0, 1), x_axis: (1, 0, 0), visits: ["floor"]),
    planes: [(name: "after", at: After("mesh")), (name: "receiver", at: Before("floor"))],
    window: (x: Hann(0.5), u: Hann(0.5)),
    frequencies: (azimuths: 2, rho: (max: 4), nu: (max: 4)),
)"#;

/// A mesh as mirror. Its curvatures are fitted to the vertices around the hit of the central ray.
const MIRROR: &str = r#"(
    light: Projector(center: (-0.644217687, 0, 0.764842187), image: (width: (0.12, 0.12))),
    surfaces: [Mesh(name: "mesh", center: (0, 0, 0), mesh: File("NAME"), event: Mirror)],
    path: (direction: (0.644217687, 0, -0.764842187), x_axis: (1, 0.2, 0), visits: ["mesh"]),
    planes: [(name: "outgoing", at: After("mesh")), (name: "beyond", at: Distance(1.7))],
    window: (x: Hann(0.15), u: Hann(0.15)),
    frequencies: (azimuths: 2, rho: (max: 10), nu: (max: 10)),
)"#;

/// A hand-written OBJ file that uses most features of the format.
const OBJ: &str = "# made by hand\nmtllib none.mtl\no tetra\nv 1 1 1 0.5 0.5 0.5\nv -1. -1 1\n\
    v -1 1 -1 \nv +1 -1e0 -1\nvn 0 0 1\nvt 0.5 .5\ng one two\nusemtl red\ns 1\nf 1/1/1 2/1/1 3//1\n\
    f 1 4 \\\n 2\ng\nf -4 -2 -1\nf 2 4 3\nl 1 2 3\np 1\nv 2 2 2\nv 2 3 2\nv 3 3 2\nv 3 2 2\n\
    f 5 6 7 8\n";

const PLY: &str = "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info none\r\n\
    element vertex 4\r\nproperty uchar red\r\nproperty float x\r\nproperty double y\r\n\
    property short z\r\nelement extra 2\r\nproperty list uchar float values\r\nelement face 4\r\n\
    property list uchar uint vertex_indices\r\nproperty char kind\r\nend_header\r\n\
    255 1 1 1\r\n0 -1 -1 1\r\n0 -1 1 -1\r\n7 1 -1 -1\r\n2 0.5 .5\r\n0\r\n\
    3 0 1 2 0\r\n3 0 3 1 -1\r\n3 0 2 3 5\r\n3 1 3 2 0\r\n";

/// File names and contents of valid meshes.
pub(crate) type Meshes = Vec<(&'static str, Vec<u8>)>;

/// The meshes for a blocker and for a mirror.
pub(crate) fn seeds() -> Result<[Meshes; 2], Fault> {
    let star = Mesh::star(1.0, 0.3, 4, 8)?;
    let bowl = Mesh::paraboloid([-0.5, 0.3], 0.5, 16)?;
    let mut blockers = forms(&star);
    blockers.push(("mesh.obj", OBJ.into()));
    blockers.push(("mesh.ply", PLY.into()));
    Ok([blockers, forms(&bowl)])
}

/// Returns files that contain the same mesh, one for each format.
fn forms(mesh: &Mesh) -> Meshes {
    let vertices = mesh.vertices().iter().map(|v| v.to_array());
    let mut obj = String::new();
    let mut ascii = header("ascii", mesh);
    let mut big = header("binary_big_endian", mesh).into_bytes();
    for [x, y, z] in vertices {
        obj += &format!("v {x} {y} {z}\n");
        ascii += &format!("{x} {y} {z}\n");
        big.extend([x, y, z].iter().flat_map(|c| c.to_be_bytes()));
    }
    for [a, b, c] in mesh.triangles() {
        obj += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
        ascii += &format!("3 {a} {b} {c}\n");
        big.push(3);
        big.extend([a, b, c].iter().flat_map(|i| i.to_be_bytes()));
    }
    vec![
        ("mesh.obj", obj.into()),
        ("mesh.ply", ascii.into()),
        ("mesh.ply", big),
        ("mesh.ply", mesh.ply()),
    ]
}

fn header(format: &str, mesh: &Mesh) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.vertices().len(),
        mesh.triangles().len()
    )
}

/// A mutated mesh in a valid scene.
pub(crate) fn attack(seeds: &[Meshes; 2], dice: &mut Dice) -> Attack {
    let role = dice.below(2);
    let (name, whole) = dice.pick(&seeds[role]);
    let mut mesh = whole.clone();
    let end = find(&mesh, b"end_header\n").map(|at| at + 11);
    match (std::str::from_utf8(whole), end) {
        (Ok(whole), _) if !dice.one_in(4) => mesh = text::mutated(whole, WORDS, dice),
        (Err(_), Some(end)) if dice.one_in(2) => {
            let head = String::from_utf8_lossy(&whole[..end]);
            mesh = text::mutated(&head, WORDS, dice);
            mesh.extend_from_slice(&whole[end..]);
        }
        _ => bytes::mutate(&mut mesh, dice),
    }
    let scene = [BLOCKER, MIRROR][role].replace("NAME", name);
    on_scene(folder::of([(SCENE, scene.into()), (name, mesh)]), dice)
}

fn find(bytes: &[u8], part: &[u8]) -> Option<usize> {
    bytes.windows(part.len()).position(|window| window == part)
}
