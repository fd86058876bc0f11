//! Tests meshes with normals and texture coordinates.

use etendue_meshfile::{DetailedMesh, Mesh};
use glam::{DVec2, DVec3};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0.5\nvt 0.25\nvn 0 0 2\nvn 0 1 0\n\
                   f 1/1/1 2/2/1 3/3/1\nf -3/2/2 4//2 3/3/1\n";

fn parse(name: &str, text: &str) -> Result<DetailedMesh, String> {
    DetailedMesh::parse(name.as_ref(), text.as_bytes()).map_err(|fault| fault.to_string())
}

#[test]
fn corners_of_an_obj_file_are_split_where_they_differ() {
    let mesh = parse("a.OBJ", OBJ).unwrap();
    // Vertex 2 of this file has two normals, and the corner 3/3/1 occurs twice.
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 2]]);
    assert_eq!(mesh.vertices[1], mesh.vertices[3]);
    let normals = mesh.normals.unwrap();
    let (z, y) = (2.0 * DVec3::Z, DVec3::Y);
    assert_eq!(normals, [z, z, z, y, y]);
    let uvs = mesh.uvs.unwrap();
    assert_eq!(uvs[1], DVec2::new(1.0, 0.5));
    assert_eq!(uvs[2], DVec2::new(0.25, 0.0));
    // The second-last corner has no texture coordinates.
    assert_eq!(uvs[4], DVec2::ZERO);
    let plain = Mesh::parse("a.obj".as_ref(), OBJ.as_bytes()).unwrap();
    assert_eq!(plain.vertices().len(), 4);
    assert_eq!(plain.triangles().len(), 2);
}

#[test]
fn without_indices_there_are_no_normals() {
    let mesh = parse(
        "a.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1 2 3\n",
    )
    .unwrap();
    assert!(mesh.normals.is_none() && mesh.uvs.is_none());
}

#[test]
fn unsound_indices_name_their_line() {
    for (face, what) in [
        ("1/4/1 2/1/1 3/1/1", "line 10, face 1, corner 1"),
        ("1/1/3 2/1/1 3/1/1", "line 10, face 1, corner 1"),
        ("1//1 2//-3 3//1", "line 10, face 1, corner 2"),
        ("1/0 2/1 3/1", "line 10, face 1, corner 1"),
    ] {
        let head: String = OBJ
            .lines()
            .take(9)
            .map(|line| format!("{line}\n"))
            .collect();
        let error = parse("a.obj", &format!("{head}f {face}\n")).unwrap_err();
        assert!(error.starts_with(what), "{error}");
    }
    let error = parse("a.obj", "v 0 0 0\nvn 0 nan 1\nf 1 1 1\n").unwrap_err();
    assert!(error.starts_with("line 2, number 2 of vn"), "{error}");
}

#[test]
fn properties_of_a_ply_file_may_stand_in_any_order() {
    let ply = |names: [&str; 2]| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float {}\nproperty float x\nproperty float nz\n\
             property float y\nproperty float ny\nproperty float z\nproperty float nx\nproperty float {}\n\
             element face 1\nproperty list uchar int vertex_index\nend_header\n\
             0.5 0 1 0 2 0 3 0.25\n0.5 1 1 0 2 0 3 0.25\n0.5 0 1 1 2 0 3 0.25\n3 0 1 2\n",
            names[0], names[1]
        )
    };
    for names in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let mesh = parse("a.ply", &ply(names)).unwrap();
        assert_eq!(mesh.normals.unwrap()[2], DVec3::new(3.0, 2.0, 1.0));
        assert_eq!(mesh.uvs.unwrap()[2], DVec2::new(0.5, 0.25));
        assert_eq!(mesh.vertices[2], DVec3::Y);
    }
    assert!(parse("a.ply", &ply(["u", "t"])).unwrap().uvs.is_none());
}

#[test]
fn attributes_of_a_ply_file_are_read_if_wanted() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property float foo_0\nproperty float foo_1\nproperty float nx\nproperty float foo_2\nproperty float bad_y\n\
        property float one_w_1\nproperty float plain\nproperty float bent_x\nproperty float bent_z\n\
        element face 2\nproperty list uchar int vertex_index\nproperty list uchar int many_0\nproperty float red\nproperty float green\nproperty float blue\nend_header\n\
        0 0 0 1 2 9 3 0 5 0 0 0\n1 0 0 4 5 9 6 0 6 0 0 0\n1 1 0 0 0 9 0 0 7 0 0 0\n0 1 0 0 0 9 0 0 8 0 0 0\n\
        4 0 1 2 3 0 1 2 3\n3 0 1 2 1 7 4 5 6\n";
    let wanted = ["face_color", "vertex_foo", "vertex_none", "vertex_one_w"].map(str::to_owned);
    let mesh = DetailedMesh::parse_with("a.ply".as_ref(), ply.as_bytes(), &wanted).unwrap();
    let names = ["vertex_foo", "vertex_one_w", "face_color"];
    assert_eq!(mesh.attribute_names, names);
    let found = mesh.attributes.iter();
    let found: Vec<_> = found
        .map(|of| {
            (
                of.name.as_str(),
                of.channels,
                of.values.as_slice(),
                of.is_of_vertices,
            )
        })
        .collect();
    let foo = [1., 2., 3., 4., 5., 6., 0., 0., 0., 0., 0., 0.];
    // The face of four corners gives its numbers to two triangles.
    let color = [1., 2., 3., 1., 2., 3., 4., 5., 6.];
    assert_eq!(
        found,
        [
            (names[0], 3, foo.as_slice(), true),
            (names[1], 1, &[5., 6., 7., 8.], true),
            (names[2], 3, &color, false),
        ]
    );
    let plain = DetailedMesh::parse("a.ply".as_ref(), ply.as_bytes()).unwrap();
    assert!(plain.attributes.is_empty());
    let broken = ply.replace("0 0 0 1 2 9 3", "0 0 0 1 2 9 nan");
    let error = DetailedMesh::parse_with("a.ply".as_ref(), broken.as_bytes(), &wanted).unwrap_err();
    let error = error.to_string();
    assert!(
        error.starts_with("line 23, vertex 0, vertex_foo"),
        "{error}"
    );
}
