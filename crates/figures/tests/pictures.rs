//! Tests the content of finished figures: positions, colors, and the numbers beside pictures.

use crate::common::{DECIBEL, Pixels, compare, corner, images, path, scene};
use etendue_figures::{Scale, Section, section};
use ndarray::Array2;

#[test]
fn high_x_and_high_y_are_upper_right() {
    let values = corner();
    for scale in [Scale::Linear, DECIBEL] {
        let map = &images(&compare(values.view(), values.view(), scale))[0];
        assert_eq!((map.width, map.height), (5, 3), "one pixel to a cell");
        let bright: Vec<_> = (0..15)
            .filter(|i| map.brightness(i % 5, i / 5) > 300)
            .collect();
        assert_eq!(bright, [4], "the last pixel of the top row");
    }
}

/// In the PNG, each cell is a rectangle of one color too, without smoothing at its edges.
#[test]
fn the_raster_shows_cells_as_sharp_rectangles() {
    let values = corner();
    let figure = compare(values.view(), values.view(), Scale::Linear);
    let panel = figure.svg.split("<image").nth(1).unwrap();
    let number = |name: &str| -> usize {
        let text = panel.split(&format!(" {name}=\"")).nth(1).unwrap();
        text.split('"').next().unwrap().parse().unwrap()
    };
    let raster = Pixels::decode(&figure.png().unwrap());
    let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| 2 * number(name));
    let bright = raster.at(x + w - w / 10, y + h / 6);
    assert!(bright[0] > 240 && bright[1] > 240, "{bright:?}");
    // The first tested point is three pixels inside the edges of the cell and away from the frame.
    // The picture has the color of the cell there.
    assert_eq!(raster.at(x + w - w / 5 + 3, y + h / 3 - 3), bright);
    // Three pixels outside the cell, the picture has the color of the value 0.
    let dark = raster.at(x + 10, y + h - 10);
    assert!(dark.iter().all(|c| *c < 10), "{dark:?}");
    assert_eq!(raster.at(x + w - w / 5 - 3, y + h / 3 - 3), dark);
    assert_eq!(raster.at(x + w - w / 5 + 3, y + h / 3 + 3), dark);
}

#[test]
fn measured_and_predicted_share_colors_and_differences_keep_their_sign() {
    let measured = ndarray::array![[1.0, 2.0], [3.0, 4.0]];
    let predicted = ndarray::array![[4.0, 2.0], [3.0, 1.0]];
    let maps = images(&compare(measured.view(), predicted.view(), Scale::Linear));
    // Cell (0, 0) is the lower left pixel, and cell (1, 1) is the upper right pixel.
    assert_eq!(maps[0].at(1, 0), maps[1].at(0, 1), "both hold 4");
    assert_eq!(maps[0].at(0, 0), maps[1].at(0, 0), "both hold 2");
    assert_ne!(maps[0].at(0, 1), maps[1].at(0, 1));
    let [red, _, blue] = maps[2].at(1, 0);
    assert!(red > blue, "too much is red");
    let [red, _, blue] = maps[2].at(0, 1);
    assert!(blue > red, "too little is blue");
}

#[test]
fn negative_powers_look_like_the_floor_and_gaps_are_grey() {
    let measured = ndarray::array![[-1.0, f64::NAN], [1e-9, 1.0]];
    let predicted = ndarray::array![[0.0, 0.5], [0.0, 1.0]];
    let figure = compare(measured.view(), predicted.view(), DECIBEL);
    let map = &images(&figure)[0];
    assert_eq!(map.at(0, 1), map.at(1, 1), "−1 and 1e-9");
    let [r, g, b] = map.at(0, 0);
    assert!(r == g && g == b && (100..200).contains(&r), "NaN");
    assert!(figure.svg.contains("no value"));
    let whole = compare(predicted.view(), predicted.view(), DECIBEL);
    assert!(!whole.svg.contains("no value"));
}

#[test]
fn the_png_has_twice_the_size_of_the_svg_and_the_same_bytes_every_time() {
    let values = corner();
    let scene = scene(3);
    let draw = || {
        [
            compare(values.view(), values.view(), DECIBEL),
            path(&scene, values.view()),
            section(&scene, "cut", "").unwrap(),
        ]
    };
    for (first, second) in draw().iter().zip(&draw()) {
        assert_eq!(first, second);
        let (png, again) = (first.png().unwrap(), second.png().unwrap());
        assert_eq!(png, again);
        let raster = Pixels::decode(&png);
        let size = format!(
            "width=\"{}\" height=\"{}\"",
            raster.width / 2,
            raster.height / 2
        );
        assert!(
            first
                .svg
                .starts_with(&format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {size}"))
        );
    }
}

#[test]
fn the_png_states_its_resolution() {
    let values = corner();
    let png = compare(values.view(), values.view(), DECIBEL)
        .png()
        .unwrap();
    let chunk = png.windows(4).position(|bytes| bytes == b"pHYs").unwrap() + 4;
    let per_metre = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    // The expected resolution is 192 pixels per inch, and an inch has 0.0254 metres.
    assert_eq!([per_metre(chunk), per_metre(chunk + 4)], [7559, 7559]);
    assert_eq!(png[chunk + 8], 1, "the unit is the metre");
}

/// Only the title is in this corner of the figure, so ink in this corner shows that the built-in
/// fonts work.
#[test]
fn text_is_drawn() {
    let values = corner();
    let raster = Pixels::decode(
        &compare(values.view(), values.view(), DECIBEL)
            .png()
            .unwrap(),
    );
    let ink = (0..60)
        .flat_map(|row| (100..500).map(move |column| (column, row)))
        .filter(|(column, row)| raster.brightness(*column, *row) < 300)
        .count();
    assert!(ink > 500, "{ink} dark pixels"); // 16 bold letters of 30 pixels height are about 3000
}

#[test]
fn tables_have_a_header_with_units_and_a_row_for_each_cell() {
    let values = corner();
    let figure = compare(values.view(), values.view(), DECIBEL);
    let mut lines = figure.csv.lines();
    assert_eq!(
        lines.next(),
        Some("x [m],u,measured L [W m⁻² sr⁻¹],predicted L [W m⁻² sr⁻¹],(measured − predicted) / σ")
    );
    assert_eq!(lines.clone().count(), 15);
    assert_eq!(lines.last(), Some("0.4,0.3333333333333333,1.0,1.0,0.0"));

    let strip = path(&scene(2), values.view());
    assert!(
        strip
            .csv
            .starts_with("plane,distance [m],picture,x axis,x,")
    );
    assert_eq!(strip.csv.lines().count(), 1 + 2 * 2 * 15);
    assert!(strip.csv.contains("plane_1,1.0,spectrum,x [m],0.8,u,"));

    let cut = section(&scene(2), "", "").unwrap();
    assert!(
        cut.csv
            .starts_with("kind,name,z0 [m],x0 [m],z1 [m],x1 [m]\n")
    );
    // The rows of the CSV are the central ray, four segments, two planes and four corners.
    assert_eq!(cut.csv.lines().count(), 1 + 1 + 4 + 2 + 4);
}

#[test]
fn empty_tiny_and_flat_arrays_are_drawn() {
    let odd = [
        Array2::zeros((0, 0)),
        Array2::zeros((0, 4)),
        Array2::zeros((1, 1)),
        Array2::zeros((6, 6)),
        Array2::from_elem((2, 2), f64::NAN),
        Array2::from_elem((2, 2), -1.0),
        Array2::from_elem((2, 2), f64::INFINITY),
    ];
    for values in odd {
        for scale in [Scale::Linear, DECIBEL, Scale::Decibel { floor: 3.0 }] {
            compare(values.view(), values.view(), scale).png().unwrap();
        }
        path(&scene(1), values.view()).png().unwrap();
    }
    let nothing = Section {
        across: "*x*".to_owned(),
        length: 0.0,
        unfolded: false,
        half_width: 0.0,
        segments: Vec::new(),
        planes: Vec::new(),
        bodies: Vec::new(),
        other: None,
        world: None,
    };
    section(&nothing, "", "").unwrap().png().unwrap();
    path(&nothing, corner().view()).png().unwrap();
}

#[test]
fn what_is_endless_ends_in_an_arrow_at_the_border() {
    let mut cut = scene(2);
    let polygons = |cut: &Section| section(cut, "", "").unwrap().svg.matches("Z\"").count();
    let before = polygons(&cut);
    cut.segments[1].end[1] = f64::INFINITY;
    cut.segments[2].start[1] = f64::NEG_INFINITY;
    assert_eq!(polygons(&cut), before + 2);
}

#[test]
#[should_panic(expected = "shape of predicted")]
fn arrays_of_different_shapes_are_refused() {
    let (a, b) = (Array2::zeros((2, 3)), Array2::zeros((1, 1)));
    compare(a.view(), b.view(), Scale::Linear);
}
