//! Helpers shared by the tests of the figures.

#![allow(
    dead_code,
    clippy::unwrap_used,
    unreachable_pub,
    reason = "each test program uses a part; a fault here fails the test"
)]

use base64::Engine;
use etendue_field::Side;
use etendue_figures::{
    Axis, AxisQuantity, Bars, Comparison, Error, Figure, Guide, Picture, PlaneMark, Plate,
    PlateRow, Scale, Section, Segment, SegmentKind, Strip, Style, comparison, plate, strip,
};
use ndarray::{Array2, ArrayView2};

/// An image as RGB pixels, row by row from the top.
pub struct Pixels {
    pub width: usize,
    pub height: usize,
    pub values: Vec<[u8; 3]>,
}

impl Pixels {
    pub fn decode(bytes: &[u8]) -> Self {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut buffer).unwrap();
        let samples = info.color_type.samples();
        let used = buffer[..info.buffer_size()].chunks_exact(samples);
        Self {
            width: info.width as usize,
            height: info.height as usize,
            values: used.map(|p| [p[0], p[1], p[2]]).collect(),
        }
    }

    pub fn at(&self, column: usize, row: usize) -> [u8; 3] {
        self.values[row * self.width + column]
    }

    pub fn brightness(&self, column: usize, row: usize) -> u32 {
        self.at(column, row).iter().map(|c| u32::from(*c)).sum()
    }
}

/// The embedded images of a figure, in the order in which they are drawn.
pub fn images(figure: &Figure) -> Vec<Pixels> {
    let parts = figure.svg.split("data:image/png;base64,").skip(1);
    parts
        .map(|part| {
            let text = part.split('"').next().unwrap();
            let engine = base64::engine::general_purpose::STANDARD;
            Pixels::decode(&engine.decode(text).unwrap())
        })
        .collect()
}

pub fn compare(
    measured: ArrayView2<'_, f64>,
    predicted: ArrayView2<'_, f64>,
    scale: Scale,
) -> Figure {
    let z = &measured - &predicted;
    comparison(&Comparison {
        title: "A <title> & more",
        note: "*p* = 0.43, pass",
        x: Axis::edges("*x*", "m", [-0.5, 0.5]),
        y: Axis::edges("*u*", "", [-0.5, 0.5]),
        quantity: AxisQuantity::new("*L*", "W m⁻² sr⁻¹"),
        scale,
        sides: ["measured", "predicted"],
        measured,
        predicted,
        z: z.view(),
        finer: None,
    })
    .unwrap()
}

pub const DECIBEL: Scale = Scale::Decibel { floor: -60.0 };

/// A cut with a light, two blockers, a receiver and `count` planes.
pub fn scene(count: usize) -> Section {
    let segment = |kind, z: f64, x: [f64; 2], label: &str| Segment {
        kind,
        start: [z, x[0]],
        end: [z, x[1]],
        label: Some(label.to_owned()),
    };
    Section {
        across: "*x*".to_owned(),
        length: 2.0,
        unfolded: false,
        half_width: 0.6,
        segments: vec![
            segment(SegmentKind::Light, 0.0, [-0.1, 0.1], "light"),
            segment(SegmentKind::Blocker, 1.0, [0.2, 0.5], "blockers"),
            segment(SegmentKind::Blocker, 1.0, [-0.5, -0.2], "blockers"),
            segment(SegmentKind::Surface, 2.0, [-3.0, 3.0], "floor"),
        ],
        planes: (0..count)
            .map(|i| PlaneMark {
                name: format!("plane_{i}"),
                distance: 2.0 * i as f64 / count as f64,
                side: if i % 2 == 0 {
                    Side::After
                } else {
                    Side::Before
                },
            })
            .collect(),
        bodies: vec![vec![[0.4, 0.0], [0.5, 0.1], [0.6, 0.0], [0.5, -0.1]]],
        other: None,
        world: None,
    }
}

pub fn path(section: &Section, values: ArrayView2<'_, f64>) -> Figure {
    path_in(section, values, &Style::default()).unwrap()
}

/// The same in a style.
pub fn path_in(
    section: &Section,
    values: ArrayView2<'_, f64>,
    style: &Style,
) -> Result<Figure, Error> {
    let ends = |name, unit| Axis::edges(name, unit, [-1.0, 1.0]);
    let picture = || Picture::new([ends("*x*", "m"), ends("*u*", "")], values);
    let guide = Guide {
        through: [0.0, 0.0],
        slope: -1.0,
        is_across: false,
    };
    let across = Guide {
        slope: -0.5,
        is_across: true,
        ..guide
    };
    let spectrum = || Picture {
        guides: vec![guide, across],
        ..picture()
    };
    let planes = || section.planes.iter();
    let row = |name, scale, unit, pictures| {
        let quantity = AxisQuantity::new("*L*", unit);
        PlateRow::new(name, quantity, scale, false, pictures)
    };
    let verdict = ["*p* = 0.5, pass", "*χ*^{2}/dof = 1.01"].map(str::to_owned);
    let light_fields = planes().map(|_| picture()).collect();
    let spectra = planes().map(|_| spectrum()).collect();
    let path = Strip {
        title: "The path",
        note: "",
        section,
        rows: vec![
            row("light field", Scale::Linear, "W m⁻² sr⁻¹", light_fields),
            row("spectrum", DECIBEL, "W²", spectra),
        ],
        verdicts: planes().map(|_| verdict.to_vec()).collect(),
    };
    strip(&path, style)
}

/// A 5 × 3 array with one bright cell at high x and high y.
pub fn corner() -> Array2<f64> {
    let mut values = Array2::zeros((5, 3));
    values[[4, 2]] = 1.0;
    values
}

/// A plate of `count` columns, with long texts and bars.
pub fn grid(count: usize, values: ArrayView2<'_, f64>) -> Figure {
    plate_of(count, values, |_| [16.5, 32.5])
}

/// A plate of `count` columns with different axes for each picture.
pub fn uneven_grid(count: usize, values: ArrayView2<'_, f64>) -> Figure {
    plate_of(count, values, |i| {
        [0.15 + 0.2 * i as f64, 0.3 + 7.0 * i as f64]
    })
}

fn plate_of(count: usize, values: ArrayView2<'_, f64>, ends: fn(usize) -> [f64; 2]) -> Figure {
    let picture = |i| {
        let [x, y] = ends(i);
        let x = Axis::edges("*ρ*", "cycles/m", [-x, x]);
        let y = Axis::edges("*ν*", "cycles per unit slope", [-y, y]);
        Picture::new([x, y], values)
    };
    let row = |name: &'static str, scale, shared| {
        let quantity = AxisQuantity::new("∬ *L W* d*y* d*v*", "W m^{−2} sr^{−1} m");
        let pictures = (0..count).map(picture).collect();
        PlateRow::new(name, quantity, scale, shared, pictures)
    };
    let some = |value: f64| vec![Some(value); count];
    let rows = Plate {
        title: "A plate",
        note: "and a note below it",
        heads: (0..count)
            .map(|i| format!("a column of number {i}"))
            .collect(),
        rows: vec![
            row("light field", Scale::Linear, true),
            row("predicted", DECIBEL, false),
            row("phase", Scale::Phase, true),
        ],
        feet: vec![
            vec![
                "*p* = 0.123, pass".to_owned(),
                "*χ*^{2}/dof = 1.002".to_owned()
            ];
            count
        ],
        bars: Some(Bars {
            quantity: AxisQuantity::new("*H* above 1.33 cycles/m", "%"),
            about: "*H*, the share of something".to_owned(),
            measured: some(1.5),
            errors: some(0.2),
            predicted: some(1.4),
        }),
        side: None,
    };
    plate(&rows, &Style::default()).unwrap()
}
