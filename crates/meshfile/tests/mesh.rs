//! Tests mesh files and generated surfaces. Refused files have the expected messages.

use etendue_meshfile::{DetailedMesh, Fault, Mesh};
use glam::{DAffine3, DVec3};
use ply_rs_bw::{parser::Parser, ply::DefaultElement, ply::Property};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::Path;

const CUBE_OBJ: &[u8] = include_bytes!("meshes/cube.obj");
const CUBE_PLY: &[u8] = include_bytes!("meshes/cube.ply");

fn read(name: &str, bytes: impl AsRef<[u8]>) -> Result<Mesh, Fault> {
    Mesh::parse(Path::new(name), bytes.as_ref())
}

/// The enclosed volume, by the divergence theorem; positive when triangles face outward.
fn volume(mesh: &Mesh) -> f64 {
    mesh.corners()
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum()
}

/// Checks whether triangles pass every edge exactly once in each direction, so that two triangles
/// share each edge and agree on the outside.
fn closed(mesh: &Mesh) -> bool {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for [a, b, c] in mesh.triangles() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let key = [*from.min(to), *from.max(to)];
            edges.entry(key).or_default()[usize::from(from < to)] += 1;
        }
    }
    edges.values().all(|walks| *walks == [1, 1])
}

/// The Euler characteristic of a closed mesh, which is vertices − edges + faces: 2 for
/// the topology of a sphere.
fn euler(mesh: &Mesh) -> usize {
    mesh.vertices().len() + mesh.triangles().len() - mesh.triangles().len() * 3 / 2
}

#[test]
fn cubes_of_both_formats_are_the_unit_cube() {
    for mesh in [read("a.obj", CUBE_OBJ), read("a.ply", CUBE_PLY)] {
        let mesh = mesh.unwrap();
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (8, 12));
        assert_eq!(mesh.bounds(), [DVec3::ZERO, DVec3::ONE]);
        assert!(closed(&mesh) && euler(&mesh) == 2);
        assert!((volume(&mesh) - 1.0).abs() < 1e-15); // rounding of twelve terms
    }
}

/// A quadrilateral becomes a fan about its first corner, for every kind of line end.
#[test]
fn line_ends_of_all_kinds_and_a_fan() {
    let obj = "\u{feff}v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 4 1\n";
    let ply = std::str::from_utf8(CUBE_PLY).unwrap();
    for end in ["\n", "\r\n", "\r"] {
        let square = read("a.OBJ", obj.replace('\n', end)).unwrap();
        assert_eq!(square.triangles(), [[1, 2, 3], [1, 3, 0]]);
        let cube = read("a.Ply", ply.replace('\n', end)).unwrap();
        assert_eq!(cube, read("a.ply", ply).unwrap());
        let cut = ply.trim_end().replace('\n', end);
        assert_eq!(cube, read("a.ply", cut).unwrap());
    }
}

/// Reads a triangle from binary PLY files of every pair of types, in either byte order.
#[test]
fn binary_ply_of_all_types_and_both_orders() {
    let types = [
        ("char", 1),
        ("uint8", 1),
        ("short", 2),
        ("uint16", 2),
        ("int", 4),
        ("uint32", 4),
        ("float32", 4),
        ("double", 8),
    ];
    let put = |file: &mut Vec<u8>, (name, size): (&str, usize), value: u8, big: bool| {
        let mut bytes = match name {
            "float32" => f32::from(value).to_le_bytes().to_vec(),
            "double" => f64::from(value).to_le_bytes().to_vec(),
            _ => u64::from(value).to_le_bytes()[..size].to_vec(),
        };
        if big {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    for (big, order) in [(false, "little"), (true, "big")] {
        for coordinate in types {
            for (length, index) in types[..6]
                .iter()
                .flat_map(|l| types[..6].iter().map(move |i| (*l, *i)))
            {
                let mut file = format!(
                    "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty uchar skip\n\
                     property {0} x\nproperty {0} y\nproperty list uchar short skip2\nproperty {0} z\n\
                     element face 1\nproperty list {1} {2} vertex_indices\nend_header\n",
                    coordinate.0, length.0, index.0
                )
                .into_bytes();
                for point in [[1, 2, 3], [4, 5, 127], [7, 9, 0]] {
                    put(&mut file, types[1], 200, big);
                    put(&mut file, coordinate, point[0], big);
                    put(&mut file, coordinate, point[1], big);
                    file.extend([2, 1, 2, 3, 4]);
                    put(&mut file, coordinate, point[2], big);
                }
                put(&mut file, length, 3, big);
                for corner in [2, 0, 1] {
                    put(&mut file, index, corner, big);
                }
                let mesh = read("a.ply", file).unwrap();
                let points = [[1.0, 2.0, 3.0], [4.0, 5.0, 127.0], [7.0, 9.0, 0.0]];
                assert_eq!(mesh.vertices(), points.map(DVec3::from_array));
                assert_eq!(mesh.triangles(), [[2, 0, 1]]);
            }
        }
    }
}

/// Files that we write are read back exactly, also by an independent reader.
#[test]
fn written_ply_reads_back_here_and_elsewhere() {
    let mesh = Mesh::star(0.7, 0.3, 5, 20).unwrap();
    let bytes = mesh.ply();
    assert_eq!(read("a.ply", &bytes).unwrap(), mesh);

    let theirs = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice());
    let payload = theirs.unwrap().payload;
    for (vertex, ours) in payload["vertex"].iter().zip(mesh.vertices()) {
        let found = ["x", "y", "z"].map(|axis| vertex[axis].clone());
        assert_eq!(found, ours.to_array().map(Property::Double));
    }
    for (face, ours) in payload["face"].iter().zip(mesh.triangles()) {
        assert_eq!(face["vertex_indices"], Property::ListUInt(ours.to_vec()));
    }
    let counts = [payload["vertex"].len(), payload["face"].len()];
    assert_eq!(counts, [mesh.vertices().len(), mesh.triangles().len()]);
}

/// This project and tobj read the same triangles from an OBJ file. The test omits three statements
/// that tobj does not read correctly. Of these, tobj takes the `l` line for a triangle, refuses a
/// colour that only some vertices have, and refuses the continued line.
#[test]
fn obj_agrees_with_an_independent_reader() {
    let text = std::str::from_utf8(CUBE_OBJ).unwrap();
    let text = text
        .replace("l 1 2 3\n", "")
        .replace("0 1 0 0\n", "0\n")
        .replace("\\\n", "");
    let options = tobj::GPU_LOAD_OPTIONS;
    let materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, materials).unwrap();
    let theirs = models.iter().flat_map(|model| {
        let point = |i: &u32| DVec3::from_slice(&model.mesh.positions[3 * *i as usize..]);
        model.mesh.indices.iter().map(point)
    });
    let ours = read("a.obj", &text).unwrap();
    assert_eq!(
        theirs.collect::<Vec<_>>(),
        ours.corners().flatten().collect::<Vec<_>>()
    );
}

#[test]
fn the_extension_tells_the_format() {
    assert_eq!(read("cube.OBJ", CUBE_OBJ), read("a.obj", CUBE_OBJ));
    for (name, bytes, words) in [
        (
            "cube.stl",
            CUBE_OBJ,
            "the extension is `stl`; allowed: obj, ply",
        ),
        ("empty.ply", b"", "the file is empty; allowed: a mesh"),
    ] {
        assert_eq!(read(name, bytes).unwrap_err().to_string(), words);
    }
}

#[test]
fn faults_of_obj_files_are_told() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    #[rustfmt::skip]
    let cases = [
        ("f 1 2 3 5", "line 5, face 1, corner 4 is 5; allowed: 1 to 4, or -4 to -1"),
        ("f 1 2 3\nf 1 2 -5", "line 6, face 2, corner 3 is -5; allowed: 1 to 4, or -4 to -1"),
        ("f 1 2 0", "face 1, corner 3 is 0; allowed: 1 to 4, or -4 to -1"),
        ("f 1 2 -9223372036854775808", "corner 3 is -9223372036854775808; allowed: 1 to 4"),
        ("f 1/-9223372036854775808 2 99999999999999999999", "corner 3 is `99999999999999999999`; allowed: an index"),
        ("f 1 2", "line 5, face 1, number of corners is 2; allowed: 3 to 4096"),
        ("f", "line 5, face 1, number of corners is 0; allowed: 3 to 4096"),
        ("f 1 2 three", "line 5, face 1, corner 3 is `three`; allowed: an index"),
        ("f 1 2 3/x", "corner 3 is `3/x`; allowed: an index"),
        ("f 1 2 3/1/1/1", "corner 3 is `3/1/1/1`; allowed: an index"),
        ("f 1.5 2 3", "corner 1 is `1.5`; allowed: an index"),
        ("v nan 0 0", "line 5, vertex 5, x is NaN; allowed: -1000000000.0 to 1000000000.0"),
        ("v 0 -inf 0", "line 5, vertex 5, y is -inf; allowed: -1000000000.0"),
        ("v 0 0 2e9", "line 5, vertex 5, z is 2000000000.0; allowed: -1000000000.0"),
        ("v 0 0 1e999", "vertex 5, z is inf; allowed: -1000000000.0"),
        ("v 0 zero 0", "line 5, vertex 5, y is `zero`; allowed: a number"),
        ("v 0 0", "line 5, vertex 5, z is missing; allowed: a number"),
        ("# nothing", "faces (`f` lines) is 0; allowed: at least 1"),
        ("f 1 1 2\nf 1 2 2", "triangles with an area is 0; allowed: at least 1"),
        ("surf 0 1 0 1 1 2 3", "line 5, the word is `surf`; allowed: v, f and"),
        ("f\\\n1 2 9", "line 5, face 1, corner 3 is 9; allowed: 1 to 4"),
    ];
    for (text, words) in cases {
        let told = read("a.obj", format!("{square}{text}"))
            .unwrap_err()
            .to_string();
        assert!(told.contains(words), "{text}: {told}");
    }
    let told = read("a.obj", "vt 0 0\n").unwrap_err().to_string();
    assert_eq!(told, "vertices (`v` lines) is 0; allowed: at least 3");
}

/// A PLY file of a triangle with `from` replaced by `to`; the file must contain `from`.
fn edited(from: &str, to: &str) -> String {
    let sound = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                 0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert!(read("a.ply", sound).is_ok());
    assert!(sound.contains(from), "{from} is not in the file");
    sound.replacen(from, to, 1)
}

#[test]
fn faults_of_ply_files_are_told() {
    #[rustfmt::skip]
    let cases = [
        ("ply\n", "plywood\n", "line 1 is `plywood`; allowed: ply"),
        ("ascii 1.0", "binary_middle_endian 1.0", "line 2 is `format binary_middle_endian 1.0`; allowed: format ascii 1.0, format binary_little_endian 1.0"),
        ("ascii 1.0", "ascii 2.0", "line 2 is `format ascii 2.0`; allowed: format ascii 1.0"),
        ("format ascii 1.0\n", "", "format is missing; allowed: format ascii 1.0"),
        ("format", "format ascii 1.0\nformat", "line 3 is `format ascii 1.0`; allowed: one format line"),
        ("format", "\u{1}\u{2}garbage\nformat", "line 2 is `\\u{1}\\u{2}garbage`; allowed: format, comment"),
        ("element vertex 3", "element vertex three", "line 3 is `element vertex three`; allowed: element NAME COUNT"),
        ("element vertex 3", "element vertex -3", "line 3 is `element vertex -3`; allowed: element NAME COUNT"),
        ("element vertex 3", "element vertex 1000000000000", "number of bytes after the header is 26; allowed: at least 6000000000001, because the header declares 1000000000000 vertex, 1 face"),
        ("element vertex 3", "element vertex 18446744073709551615", "bytes after the header is 26; allowed: at least 110680464442257309691,"),
        ("element vertex 3\n", "property int n\nelement vertex 3\n", "line 3 is `property int n`; allowed: an element that stands before"),
        ("property float x", "property half x", "line 4 is `property half x`; allowed: property TYPE NAME"),
        ("property float x\n", "property float x\nproperty uchar x\n", "line 5 is `property uchar x`; allowed: each property once"),
        ("element face", "element vertex 3\nelement face", "line 7 is `element vertex 3`; allowed: each element once"),
        ("list uchar", "list float", "line 8 is `property list float int vertex_indices`; allowed: property TYPE"),
        ("property float y\n", "", "property y of element vertex is missing; allowed: property float x, y and z"),
        ("vertex_indices", "corners", "property vertex_indices of element face is missing; allowed: property list uchar int vertex_indices"),
        ("uchar int", "uchar float", "property vertex_indices of element face is missing"),
        ("element face", "element facet", "element face of the header is missing; allowed: elements vertex and face"),
        ("element vertex 3", "element vertex 0", "vertices is 0; allowed: at least 3"),
        ("element face 1", "element face 0", "faces is 0; allowed: at least 1"),
        ("end_header", "element odd 1000000000000\nend_header", "number of properties of element odd is 0; allowed: at least 1"),
        ("end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "", "end_header is missing, because the file ends; allowed: a complete header"),
        ("0 1 0\n3 0 1 2\n", "0 1 0\n", "number of bytes after the header is 18; allowed: at least 19, because the header declares 3 vertex, 1 face"),
        ("0 1 0\n3 0 1 2\n", "0000 1 0\n", "line 13, face 0, vertex_indices is missing, because the file ends; allowed: 1 rows of element face"),
        ("1 0 0\n0 1 0\n3 0 1 2\n", "1.00000000000 0.0", "line 11, vertex 1, z is missing, because the file ends; allowed: 3 rows of element vertex"),
        ("1 0 0\n", "1 0\n", "line 11, vertex 1, z is missing, because the line ends; allowed: a value for each property"),
        ("1 0 0\n", "1 0 0 0\n", "line 11, vertex 1, the next word is `0`; allowed: the end of the line"),
        ("1 0 0\n", "1 zero 0\n", "line 11, vertex 1, y is `zero`; allowed: a number"),
        ("1 0 0\n", "1 NaN 0\n", "line 11, vertex 1, y is NaN; allowed: -1000000000.0 to 1000000000.0"),
        ("1 0 0\n", "1 inf 0\n", "line 11, vertex 1, y is inf; allowed: -1000000000.0 to"),
        ("1 0 0\n", "-3e9 0 0\n", "line 11, vertex 1, x is -3000000000.0; allowed: -1000000000.0 to"),
        ("3 0 1 2\n", "3 0 1 3\n", "line 13, face 0, corner 3 is 3; allowed: 0 to 2"),
        ("3 0 1 2\n", "3 0 1 -1\n", "line 13, face 0, corner 3 is -1; allowed: 0 to 2"),
        ("3 0 1 2\n", "3 0 1 1.5\n", "line 13, face 0, corner 3 is 1.5; allowed: 0 to 2"),
        ("3 0 1 2\n", "2 0 1\n\n", "line 13, face 0, number of corners is 2; allowed: 3 to 4096"),
        ("3 0 1 2\n", "-3 0 1 2\n", "line 13, face 0, vertex_indices is -3 long; allowed: a list that"),
        ("3 0 1 2\n", "4 0 1 2", "line 13, face 0, vertex_indices is missing, because the file ends; allowed: 1 rows of element face"),
        ("3 0 1 2\n", "3 0 1 1\n", "triangles with an area is 0; allowed: at least 1"),
        ("3 0 1 2\n", "3 0 1 2\n3 0 2 1\n", "the rest of the file is 7 bytes long; allowed: empty, because"),
    ];
    for (from, to, words) in cases {
        let told = read("a.ply", edited(from, to)).unwrap_err().to_string();
        assert!(told.contains(words), "{from:?} -> {to:?}: {told}");
    }
}

/// A binary file that is cut at any byte, or has impossible values, is refused.
#[test]
fn faults_of_binary_ply_files_are_told() {
    let sound = Mesh::star(1.0, 0.0, 0, 2).unwrap().ply(); // 6 vertices, 8 triangles
    let data = sound.len() - 6 * 24 - 8 * 13;
    for length in 0..sound.len() {
        read("a.ply", &sound[..length]).unwrap_err();
    }
    let with = |at: usize, bytes: &[u8]| {
        let mut file = sound.clone();
        file[data + at..][..bytes.len()].copy_from_slice(bytes);
        read("a.ply", file).unwrap_err().to_string()
    };
    let cut = read("a.ply", &sound[..sound.len() - 1])
        .unwrap_err()
        .to_string();
    for (told, words) in [
        (
            cut,
            "face 7, vertex_indices is missing, because the file ends; allowed: 8 rows of element face",
        ),
        (
            with(2 * 24 + 8, &f64::NAN.to_le_bytes()),
            "vertex 2, y is NaN; allowed: -1000000000.0 to",
        ),
        (
            with(6 * 24 + 13 + 5, &6_u32.to_le_bytes()),
            "face 1, corner 2 is 6; allowed: 0 to 5",
        ),
        (
            with(6 * 24 + 13, &[2]),
            "face 1, number of corners is 2; allowed: 3 to 4096",
        ),
    ] {
        assert!(told.contains(words), "{told}");
    }
}

/// If the header has the line ends of another system, the binary data begin directly after the
/// header's last line end.
#[test]
fn binary_ply_behind_all_line_ends() {
    let mesh = Mesh::star(1.0, 0.0, 0, 2).unwrap();
    let file = mesh.ply();
    let (header, data) = file.split_at(file.len() - 6 * 24 - 8 * 13);
    let header = std::str::from_utf8(header).unwrap();
    for end in ["\r\n", "\r"] {
        let header = header.replace('\n', end);
        let whole = [header.as_bytes(), data].concat();
        assert_eq!(read("a.ply", whole).unwrap(), mesh);
        let faulty = header.replace("double y", "half y");
        let told = read("a.ply", faulty).unwrap_err().to_string();
        assert!(told.starts_with("line 5 is `property half y`"), "{told}");
    }
}

/// A list with a stated length of four thousand million is read up to the end of the file, and no
/// memory is allocated in advance.
#[test]
fn a_list_longer_than_the_file_is_told() {
    let ascii = edited("uchar int", "uint int").replace("ascii", "binary_little_endian");
    let mut file = ascii.as_bytes()[..ascii.find("0 0 0").unwrap()].to_vec();
    file.extend([0; 36]);
    file.extend([0xff; 4]);
    file.extend([0; 40]);
    let told = read("a.ply", file).unwrap_err().to_string();
    assert!(
        told.contains("face 0, vertex_indices is missing, because the file ends"),
        "{told}"
    );
}

/// Fuzzed files are valid files with bytes changed, removed, doubled or cut. The result for each
/// file is a valid mesh or a fault in one line.
#[test]
fn no_bytes_make_a_reader_panic() {
    let star = Mesh::star(1.0, 0.2, 2, 4).unwrap().ply();
    let big = edited("", "").replace("format ascii", "format binary_big_endian");
    let mut big = big.as_bytes()[..big.find("end_header\n").unwrap() + 11].to_vec();
    for value in [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        big.extend(value.to_be_bytes());
    }
    big.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    let files: [(&str, &[u8]); 4] = [
        ("a.obj", CUBE_OBJ),
        ("a.ply", CUBE_PLY),
        ("a.ply", &star),
        ("a.ply", &big),
    ];
    let mut state = 1_u64;
    let mut below = |n: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1); // Knuth's generator
        usize::try_from(state >> 33).unwrap() % n
    };
    let spice = b"0123456789-+.eEnainf/\\#vf \r\n\t\0\xff\x80";
    let (mut sound, mut refused) = ([0; 4], [0; 4]);
    for case in 0..40_000 {
        let (name, file) = files[case % files.len()];
        let mut bytes = read(name, file).map(|_| file.to_vec()).unwrap();
        for _ in 0..=below(4) {
            let at = below(bytes.len());
            match below(6) {
                0 => bytes[at] ^= 1 << below(8),
                1 => bytes[at] = spice[below(spice.len())],
                2 if bytes.len() > 1 => drop(bytes.remove(at)),
                3 => bytes.insert(at, spice[below(spice.len())]),
                4 => bytes.truncate(at.max(1)),
                _ => bytes.extend_from_within(at..),
            }
        }
        match read(name, &bytes) {
            Ok(mesh) => {
                let count = u32::try_from(mesh.vertices().len()).unwrap();
                assert!(mesh.triangles().iter().flatten().all(|i| *i < count));
                assert!(mesh.vertices().iter().all(|v| v.abs().max_element() <= 1e9));
                assert!(!mesh.triangles().is_empty());
                sound[case % 4] += 1;
            }
            Err(error) => {
                let told = error.to_string();
                assert!(told.len() < 400 && !told.contains('\n'), "{told}");
                refused[case % 4] += 1;
            }
        }
    }
    // Fuzzed files must often be valid and often be faulty; otherwise they were changed too much
    // or too little for the test.
    let often = |counts: [u32; 4]| counts.iter().all(|n| *n > 100);
    assert!(
        often(sound) && often(refused),
        "{sound:?} sound, {refused:?} refused"
    );
}

#[test]
fn triangles_without_area_are_dropped_where_others_remain() {
    let mesh = read(
        "a.obj",
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\nf 1 1 4\n",
    );
    assert_eq!(mesh.unwrap().triangles(), [[0, 1, 3]]);
}

#[test]
fn a_star_is_closed_outward_and_of_its_volume() {
    for (relief, lobes, rings) in [
        (0.0, 0, 2),
        (0.0, 0, 30),
        (0.5, 1, 40),
        (0.3, 5, 113),
        (-0.9, 6, 60),
    ] {
        let mesh = Mesh::star(2.0, relief, lobes, rings).unwrap();
        let [vertices, triangles] = [mesh.vertices().len(), mesh.triangles().len()];
        let n = usize::try_from(rings).unwrap();
        assert_eq!(
            [vertices, triangles],
            [2 * n * (n - 1) + 2, 4 * n * (n - 1)]
        );
        assert!(
            closed(&mesh),
            "relief {relief}, lobes {lobes}, rings {rings}"
        );
        assert_eq!(euler(&mesh), 2);
        // The mesh is star-shaped, so every triangle faces away from the origin.
        let outward = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).dot(a) > 0.0;
        assert!(mesh.corners().all(outward));
    }
    assert!(Mesh::star(1.0, 0.3, 5, 113).unwrap().triangles().len() >= 50_000);
}

/// The volume of the mesh converges to the volume of the smooth surface; the difference is
/// proportional to rings⁻². With half the rings, the difference is four times as large, so
/// extrapolation gives the closed form. The closed form is ∫ (1 + ε sinˡθ cos lφ)³ / 3 over the
/// sphere, in which odd powers of the cosine vanish.
#[test]
fn the_volume_of_a_star_is_the_closed_form() {
    for (relief, lobes) in [(0.0, 3), (0.4, 3), (0.4, 4)] {
        let double_factorials: f64 = (1..=lobes)
            .map(|k| f64::from(2 * k) / f64::from(2 * k + 1))
            .product();
        let smooth = 8.0 * (4.0 / 3.0 * PI + relief * relief * 2.0 * PI * double_factorials);
        let missing =
            |rings| 1.0 - volume(&Mesh::star(2.0, relief, lobes, rings).unwrap()) / smooth;
        let (coarse, fine) = (missing(100), missing(200));
        assert!(coarse > 0.0 && coarse < 1e-3, "{coarse}"); // facets lie inside: up to 9.5e-4 here
        assert!((coarse / fine - 4.0).abs() < 5e-3, "{coarse} and {fine}"); // next order, 100⁻² times some
        let beyond = (4.0 * fine - coarse) / 3.0;
        assert!(beyond.abs() < 6e-7, "{beyond}"); // the order left, rings⁻⁴: up to 3.0e-7, a sixteenth at 400
    }
}

#[test]
fn stars_with_too_many_lobes_are_refused() {
    let told = Mesh::star(1.0, 0.1, 5, 8).unwrap_err().to_string();
    assert_eq!(told, "lobes is 5; allowed: 0 to 4, half the rings");
}

#[test]
fn a_moved_or_mirrored_mesh_keeps_its_outside() {
    let mesh = Mesh::star(1.0, 0.3, 3, 12).unwrap();
    let shift = DVec3::new(3.0, -2.0, 1.0);
    for scale in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 2.0, 3.0)] {
        let moved = mesh
            .transformed(DAffine3::from_translation(shift) * DAffine3::from_scale(scale))
            .unwrap();
        assert!(closed(&moved));
        assert!((volume(&moved) / volume(&mesh) - 6.0).abs() < 1e-12); // rounding
        let [low, high] = moved.bounds();
        assert!(
            (high - low).abs_diff_eq(scale.abs() * (mesh.bounds()[1] - mesh.bounds()[0]), 1e-12)
        ); // rounding
    }
    let flat = mesh.transformed(DAffine3::from_scale(DVec3::new(0.0, 0.0, 1.0)));
    assert_eq!(flat.unwrap_err().field, "triangles with an area");
    let far = mesh.transformed(DAffine3::from_translation(DVec3::X * 1e10));
    assert!(far.unwrap_err().field.starts_with("vertex 0, x"));
}

/// Checks the properties that every mesh must have.
#[test]
fn meshes_of_parts_are_checked() {
    let square = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    let told = |vertices, triangles| Mesh::new(vertices, triangles).unwrap_err().to_string();
    assert!(
        told(square.clone(), vec![[0, 1, 4]])
            .contains("triangle 0, a corner is 4; allowed: indices of the 4")
    );
    assert!(told(square, vec![]).contains("triangles with an area is 0"));
    assert!(told(vec![DVec3::NAN; 3], vec![[0, 1, 2]]).contains("vertex 0, x is NaN"));
}

#[test]
fn a_header_of_any_length_is_read_in_proportion() {
    let header = |n: u32, line: &dyn Fn(u32) -> String| {
        let lines: String = (0..n).map(line).collect();
        format!("ply\nformat ascii 1.0\nelement vertex 3\n{lines}end_header\n")
    };
    // The shortest of some times, since others may use the machine.
    let seconds = |text: &str| {
        let time = |_| {
            let start = std::time::Instant::now();
            let fault = Mesh::parse("a.ply".as_ref(), text.as_bytes()).unwrap_err();
            assert!(fault.to_string().len() < 500, "{fault}");
            start.elapsed().as_secs_f64()
        };
        (0..5).map(time).fold(f64::INFINITY, f64::min)
    };
    // Sixteen times as many names take 16 times as long, and some times more since they leave the
    // cache; if each is compared with all previous ones, 256 times.
    let property = |i: u32| format!("property int p{i}\n");
    let element = |i: u32| format!("element e{i} 1\nproperty int p\n");
    for line in [&property as &dyn Fn(u32) -> String, &element] {
        let [few, many] = [20_000, 320_000].map(|n| seconds(&header(n, line)));
        assert!(many < 100.0 * few, "{few} s, {many} s");
    }
    let long = header(1, &|_| format!("property int {}\n", "p".repeat(101)));
    let told = Mesh::parse("a.ply".as_ref(), long.as_bytes())
        .unwrap_err()
        .to_string();
    assert!(told.ends_with("a name of at most 100 bytes"), "{told}");
}

#[test]
fn faces_of_too_many_corners_are_refused() {
    let polygon = |count: usize| {
        let angle = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
        let vertices = (0..count).map(|i| format!("v {} {} 0\n", angle(i).cos(), angle(i).sin()));
        let corners = (1..=count).map(|i| format!(" {i}"));
        format!(
            "{}f{}",
            vertices.collect::<String>(),
            corners.collect::<String>()
        )
    };
    let file = Path::new("a.obj");
    assert!(DetailedMesh::parse(file, polygon(4096).as_bytes()).is_ok());
    for told in [
        Mesh::parse(file, polygon(4097).as_bytes()).map(drop),
        DetailedMesh::parse(file, polygon(4097).as_bytes()).map(drop),
    ] {
        let told = told.unwrap_err().to_string();
        assert_eq!(
            told,
            "line 4098, face 1, number of corners is 4097; allowed: 3 to 4096"
        );
    }
}
