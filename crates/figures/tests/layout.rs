//! Tests that texts in figures do not overlap and are not cut off.

#![expect(clippy::unwrap_used, reason = "a fault here fails the test")]

use crate::common::{DECIBEL, compare, corner, grid, path, path_in, scene, uneven_grid};
use etendue_field::Side;
use etendue_figures::{
    AxisQuantity, Chart, Curve, CurveKind, CurvePanel, Curves, Error, Figure, Scale, Style, chart,
    curves, section, stacked,
};

/// Returns figures of every kind: few and many planes, short and long names, ordinary and tiny
/// numbers, and missing values.
fn gallery() -> Vec<Figure> {
    let values = corner();
    let mut tiny = 3e-7 * &values;
    tiny[[0, 0]] = f64::NAN;
    let mut figures = Vec::new();
    for scale in [Scale::Linear, DECIBEL] {
        figures.push(compare(values.view(), values.view(), scale));
        figures.push(compare(tiny.view(), tiny.view(), scale));
    }
    for count in 1..=8 {
        let mut scene = scene(count);
        figures.push(path(&scene, values.view()));
        figures.push(section(&scene, "A title", "a note").unwrap());
        for plane in &mut scene.planes {
            plane.name += " with far more to its name than there is room for";
            plane.distance *= 1e-4;
        }
        scene.segments[1].label = Some("a second name at the same place".to_owned());
        scene.length = 2e-4;
        figures.push(path(&scene, tiny.view()));
        figures.push(section(&scene, &"A long title ".repeat(20), "").unwrap());
    }
    for count in 1..=6 {
        figures.push(grid(count, values.view()));
        figures.push(grid(count, tiny.view()));
        figures.push(uneven_grid(count, values.view()));
    }
    for count in [1, 3, 5] {
        figures.push(curves(&lines(count), &Style::default()).unwrap());
    }
    for count in [1, 2, 8, 14] {
        figures.push(chart(&named(count), &Style::default()).unwrap());
    }
    let [one, two] = [1, 3].map(|i| curves(&lines(i), &Style::default()).unwrap());
    figures.push(stacked(&[grid(4, values.view()), one, two]));
    figures
}

/// Returns panels with a curve and points; one of the panels has tiny numbers.
fn lines(count: usize) -> Curves {
    let curve = |kind, name: &str, scale: f64| Curve {
        kind,
        name: name.to_owned(),
        points: vec![[-1.0, 0.0, 0.0], [0.5, scale, 0.1 * scale]],
    };
    let panel = |i: usize| {
        let scale = if i == 0 { 3e-7 } else { 25.0 };
        CurvePanel {
            title: "*a* panel with a title that is a good deal longer than it is wide".to_owned(),
            x: AxisQuantity::new("*θ*_{0} = −*θ*_{1}", "degrees"),
            curves: vec![
                curve(CurveKind::Theory, "corrected", scale),
                curve(CurveKind::Rival, "as printed", 0.5 * scale),
                curve(CurveKind::Measured, "measured", scale),
                curve(CurveKind::OtherTheory, "corrected, elsewhere", 0.7 * scale),
                curve(CurveKind::OtherMeasured, "measured elsewhere", 0.8 * scale),
            ],
            is_log: [false, i == 2],
        }
    };
    Curves {
        title: "A title".to_owned(),
        note: String::new(),
        y: AxisQuantity::new("*B*", "cycles/slope"),
        panels: (0..count).map(panel).collect(),
    }
}

/// A chart of several names, one of which is long.
fn named(count: usize) -> Chart {
    let curve = |kind, name: &str, aside: f64, error: f64| {
        let points = (0..count).map(|i| [i as f64 + aside, 1.0 / (i + 1) as f64, error]);
        Curve::new(kind, name, points.collect())
    };
    let mut names = vec!["padded xy+uv, 4096".to_owned(); count];
    names[0] += " with far more to its name than there is room for";
    Chart {
        title: "A chart with a title that is rather long for only one name".to_owned(),
        note: "a note".to_owned(),
        y: AxisQuantity::new("*N* Var/σ^{2}", ""),
        names,
        curves: vec![
            curve(CurveKind::Rival, "independent", 0.0, 0.0),
            curve(CurveKind::Theory, "predicted", -0.15, 0.0),
            curve(CurveKind::Measured, "found", -0.15, 0.1),
            curve(CurveKind::OtherTheory, "predicted, not shifted", 0.15, 0.0),
            curve(CurveKind::OtherMeasured, "found, not shifted", 0.15, 2.0),
        ],
    }
}

/// A line through one point is a stroke, each value of a theory in a chart has a stroke of its own,
/// and a row of the CSV has the name of its value.
#[test]
fn single_values_are_visible() {
    let drawn = chart(&named(3), &Style::default()).unwrap();
    let strokes = |color: &str| drawn.svg.matches(&format!("stroke=\"{color}\"")).count();
    assert_eq!(
        [strokes("#1f6fb4"), strokes("#3b8f5a")],
        [4, 4],
        "one in the key"
    );
    assert_eq!(strokes("#c8502e"), 2);
    assert_eq!(
        drawn.svg.matches("<circle").count(),
        12,
        "open points are two circles"
    ); // 3 + 2 · 3, and the key
    assert_eq!(drawn.csv.lines().count(), 16);
    assert!(
        drawn
            .csv
            .lines()
            .nth(11)
            .unwrap()
            .contains("4096\",\"predicted, not shifted\",0.5,"),
        "{}",
        drawn.csv
    );
    let mut one = lines(1);
    one.panels[0].curves.truncate(1);
    one.panels[0].curves[0].points.truncate(1);
    let drawn = curves(&one, &Style::default()).unwrap();
    assert_eq!(drawn.svg.matches("stroke=\"#1f6fb4\"").count(), 2);
}

#[test]
fn all_texts_can_be_read() {
    for figure in gallery() {
        assert_eq!(figure.text_faults().unwrap(), Vec::<String>::new());
    }
}

#[test]
fn strips_plates_and_curves_are_no_wider_than_two_columns() {
    let values = corner();
    let strips = (1..=8).map(|count| path(&scene(count), values.view()));
    let plates = (1..=8).map(|count| grid(count, values.view()));
    let panels = (1..=5).map(|count| curves(&lines(count), &Style::default()).unwrap());
    let charts = [1, 8].map(|count| chart(&named(count), &Style::default()).unwrap());
    for figure in strips.chain(plates).chain(panels).chain(charts) {
        let [width, _] = figure.size();
        assert!(width <= 672.0, "{width} of 96 to the inch");
    }
}

/// Pictures become lower on a low page; letters keep their size, also on a narrow one.
#[test]
fn a_page_has_the_size_of_its_style() {
    let values = corner();
    let strip =
        |style: &Style| -> Result<Figure, Error> { path_in(&scene(8), values.view(), style) };
    // On a narrow page, texts take most of the height.
    for (width, share) in Style::WIDTHS.into_iter().zip([1.0, 0.9]) {
        let mut style = Style::default();
        style.width = width;
        let free = strip(&style).unwrap().size()[1];
        style.height = share * free / 96.0;
        let figure = style.within_height(strip).unwrap();
        let [across, high] = figure.size();
        assert!(
            across <= (96.0 * width).ceil() && high <= share * free,
            "{across} {high}"
        );
        assert_eq!(figure.text_faults().unwrap(), Vec::<String>::new());
    }
}

#[test]
fn planes_at_one_place_are_drawn_apart_in_their_order() {
    let mut scene = scene(4);
    for (plane, side) in
        scene
            .planes
            .iter_mut()
            .zip([Side::Before, Side::Before, Side::After, Side::After])
    {
        plane.distance = 1.0;
        plane.side = side;
    }
    let figure = section(&scene, "", "").unwrap();
    let disks = figure.svg.split("<circle cx=\"").skip(1);
    let places: Vec<f64> = disks
        .take(4)
        .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
        .collect();
    // Plane numbers are drawn on disks of radius 8.
    assert!(places.windows(2).all(|p| p[1] - p[0] >= 16.0), "{places:?}");
}

/// A plane is shifted in the drawing only if the line of the plane would cover an object.
#[test]
fn planes_in_free_space_stand_where_they_are() {
    let places = |side| {
        let mut scene = scene(1);
        scene.planes[0].distance = 0.5;
        scene.planes[0].side = side;
        section(&scene, "", "").unwrap().svg
    };
    assert_eq!(places(Side::Before), places(Side::After));
}
