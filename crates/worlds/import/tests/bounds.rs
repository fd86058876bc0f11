//! Tests small files that would take much time or memory if the work were not limited.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use crate::common::{assert_first, causes, folder, notes, read_in};
use etendue_import::{Color, Options, import};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::fmt::Write as _;
use std::io::Write as _;

#[test]
fn an_element_of_many_attributes_is_not_parsed() {
    let attributes = |count: usize| {
        (0..count).fold(String::new(), |mut all, i| {
            let _ = write!(all, " a{i}=\"=\"");
            all
        })
    };
    // An element with 64 attributes reaches the reader, which refuses the attributes as unknown.
    // Attributes in comments are not counted.
    let few = format!("<!-- {} --><shape{}/>", attributes(200), attributes(64));
    assert!(causes(&few)[0].contains("attribute a0"), "{few}");
    let many = format!("\n<shape type='sphere'{}/>", attributes(100_000));
    let found = causes(&many);
    assert_eq!(found, ["text:3:1: an element has more than 64 attributes"]);
}

#[test]
fn files_that_include_each_other_are_read_a_bounded_number_of_times() {
    const FILES: usize = 12;
    let name = |i: usize| format!("f{i}.xml");
    let text = |i: usize| {
        let others = (0..FILES).filter(|other| *other != i);
        let includes = others.map(|other| format!("<include filename=\"{}\"/>", name(other)));
        format!(
            "<scene version=\"3.0.0\">{}</scene>",
            includes.collect::<String>()
        )
    };
    let files: Vec<(String, String)> = (0..FILES).map(|i| (name(i), text(i))).collect();
    let files: Vec<(&str, &[u8])> = files
        .iter()
        .map(|(name, text)| (&**name, text.as_bytes()))
        .collect();
    let folder = folder(&files);
    let refused = import(&folder.path().join("f0.xml"), &Options::default()).unwrap_err();
    // Each refused include is counted. Nested, the includes add up to 10⁸. At most a thousand files
    // are read, with eleven includes each.
    let last = &refused.causes[refused.causes.len() - 1].message;
    let more = last
        .strip_prefix("and ")
        .and_then(|rest| rest.split(' ').next());
    let more: usize = more.unwrap().parse().unwrap();
    assert!(more < 1000 * FILES, "{last}");
}

#[test]
fn packed_meshes_unpack_to_a_bounded_size() {
    const VERTICES: u64 = 1_000_000;
    let mut raw = 0x2000_u32.to_le_bytes().to_vec();
    raw.extend(b"a\0");
    raw.extend(VERTICES.to_le_bytes());
    raw.extend(1_u64.to_le_bytes());
    raw.resize(raw.len() + 24 * usize::try_from(VERTICES).unwrap() + 12, 0);
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&raw).unwrap();
    let mut file = [0x041c_u16, 4].map(u16::to_le_bytes).concat();
    file.extend(encoder.finish().unwrap());
    let most = 64 * (file.len() - 4);
    assert!(most < raw.len() / 10, "the file is small");
    let folder = folder(&[("a.serialized", &file)]);
    let shape =
        r#"<shape type="serialized"><string name="filename" value="a.serialized"/></shape>"#;
    let causes = read_in(shape, folder.path(), Color::Luminance).unwrap_err();
    let words =
        format!("unpacks to more than {most} bytes; allowed: 64 times the size of the file");
    assert_first(&causes, &words);
}

#[test]
fn notes_are_bounded() {
    let shape = |count: usize| {
        let properties = (0..count).fold(String::new(), |mut all, i| {
            let _ = write!(all, "<float name=\"a{i}\" value=\"1\"/>");
            all
        });
        format!("<shape type=\"sphere\">{properties}</shape>")
    };
    assert_eq!(notes(&shape(100)).len(), 100);
    let many = notes(&shape(5000));
    assert_eq!(many.len(), 101);
    assert_eq!(many[100], "text: and 4900 more notes");
}

/// Pictures of a scene share its memory: a million pixels take 8 MB each as numbers, and 8 MB more
/// while their file is read.
#[test]
fn pictures_are_counted_before_they_are_decoded() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1000, 1000);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![128; 8_000_000]).unwrap();
    writer.finish().unwrap();
    let shape = |i: usize| {
        format!(
            r#"<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="{i}.png"/></texture></bsdf></shape>"#
        )
    };
    let scene: String = (0..4).map(shape).collect();
    let scene = format!("<scene version=\"3.0.0\">{scene}</scene>");
    let names: Vec<String> = (0..4).map(|i| format!("{i}.png")).collect();
    let mut files: Vec<(&str, &[u8])> = names.iter().map(|n| (&**n, &*bytes)).collect();
    files.push(("s.xml", scene.as_bytes()));
    let folder = folder(&files);
    let read = |memory: u64| {
        let options = Options {
            memory: Some(memory),
            ..Options::default()
        };
        import(&folder.path().join("s.xml"), &options)
    };
    // The files themselves take less than a megabyte.
    assert!(read(3 * 8_000_000 + 16_000_000 + 1_000_000).is_ok());
    let refused = read(2 * 8_000_000 + 16_000_000 - 1).unwrap_err();
    assert_eq!(refused.causes.len(), 2, "{refused}");
    assert!(refused.lacks_memory);
    let message = &refused.causes[0].message;
    assert!(
        message.contains("the memory to read the picture is 16000000 bytes"),
        "{message}"
    );
}
