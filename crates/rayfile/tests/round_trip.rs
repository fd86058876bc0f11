//! Tests that files of every kind have the right rays after they are read and written again. The
//! bytes of the first two files follow the descriptions of the formats.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use etendue_rayfile::mcpl::{McplFile, McplHeader, PHOTON, Particle, stat_sum_comment};
use etendue_rayfile::tm25::{self, Flags, SpectrumType, Tm25File};
use etendue_rayfile::{
    Fault, Format, PHOTON_ENERGY_LENGTH, PowerUnit, RayFile, RaySet, Wavelengths, convert, gz,
};

/// One photon of 1.98 eV, in big-endian MCPL-2, single precision, with universal code and weight.
fn mcpl_2() -> Vec<u8> {
    let mut bytes = b"MCPL002B".to_vec();
    bytes.extend(1_u64.to_be_bytes());
    for number in [1, 1, 0, 0, 1, 22, 28, 1_u32] {
        bytes.extend(number.to_be_bytes());
    }
    bytes.extend(0.25_f64.to_be_bytes());
    for text in ["maker", "a comment", "key", "blob"] {
        bytes.extend(u32::try_from(text.len()).unwrap().to_be_bytes());
        bytes.extend(text.as_bytes());
    }
    // The octahedral point (0.75, 0.5) has z = −0.25, so x = 0.5 and y = 0.25, all divided by the
    // length √(0.375).
    for number in [100.0, 200.0, -50.0, 0.75, 0.5, 1.98e-6, 3.0_f32] {
        bytes.extend(number.to_be_bytes());
    }
    bytes
}

#[test]
fn mcpl_2_in_big_endian_is_read_by_hand() {
    let bytes = mcpl_2();
    let file = McplFile::read(&bytes).unwrap();
    assert_eq!(file.write(), bytes);
    assert_eq!(file.header().comments, [b"a comment"]);
    assert_eq!(file.header().blobs, [(b"key".to_vec(), b"blob".to_vec())]);
    let set = file.rays();
    assert_eq!(set.positions, [[1.0, 2.0, -0.5]]);
    assert_eq!(set.powers, [0.25]);
    assert_eq!(set.unit, PowerUnit::Weight);
    let length = 0.375_f64.sqrt();
    for (found, expected) in set.directions[0].iter().zip([0.5, 0.25, -0.25]) {
        assert!((found - expected / length).abs() < 1e-15); // two roundings
    }
    // h c / E with h c = 1239.84198 nm eV, and E rounded to f32.
    assert!((set.wavelength(0).unwrap() - 1_239.841_98e-9 / 1.98).abs() < 1e-13);
}

/// A TM-25 file of one ray, byte by byte: radiant flux, one wavelength.
fn tm25_by_hand() -> Vec<u8> {
    let mut bytes = b"TM25".to_vec();
    bytes.extend(2013_i32.to_le_bytes());
    bytes.extend(1_i32.to_le_bytes());
    bytes.extend(f32::NAN.to_le_bytes());
    bytes.extend(0.5_f32.to_le_bytes());
    bytes.extend(1_u64.to_le_bytes());
    bytes.extend(*b"2013-09-04T08:30:29+01:00\0\0\0");
    bytes.extend(0_i32.to_le_bytes());
    bytes.extend(1_i32.to_le_bytes());
    bytes.extend(532.0_f32.to_le_bytes());
    bytes.resize(88 + 168, 0);
    for flag in [1, 1, 1, 0, 0, 0, 0, 0_i32] {
        bytes.extend(flag.to_le_bytes());
    }
    bytes.extend("LED µ".chars().flat_map(|c| u32::from(c).to_le_bytes()));
    bytes.resize(288 + 9 * 4000, 0);
    for number in [1.0, -2.0, 500.0, 0.6, 0.0, 0.8, 0.5_f32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

#[test]
fn tm25_is_read_by_hand() {
    let bytes = tm25_by_hand();
    let file = Tm25File::read(&bytes).unwrap();
    assert_eq!(file.write(), bytes);
    assert_eq!(file.header().texts[0], "LED µ");
    assert_eq!(file.notes(), [""; 0]);
    let set = file.rays();
    assert_eq!(set.positions, [[0.001, -0.002, 0.5]]);
    assert_eq!((set.total_power(), set.unit), (0.5, PowerUnit::Watt));
    assert!((set.wavelength(0).unwrap() - 532e-9).abs() < 1e-22); // a rounding
}

#[test]
fn unusual_texts_and_fluxes_have_notes() {
    let mut bytes = tm25_by_hand();
    bytes[288 + 4 * 10] = b'x'; // after the end of the first text
    bytes[288 + 4000 + 3] = 0xff; // the first character of the second text is invalid
    bytes[16..20].copy_from_slice(&1.0_f32.to_le_bytes());
    let file = Tm25File::read(&bytes).unwrap();
    assert_eq!(file.notes().len(), 3, "{:?}", file.notes());
}

/// Files with each combination of MCPL's options have the same bytes after they are read and
/// written. This also holds for packed files.
#[test]
fn mcpl_keeps_every_option() {
    for options in 0..64_u32 {
        let on = |bit: u32| options >> bit & 1 == 1;
        let header = McplHeader {
            little_endian: on(0),
            user_flags: on(1),
            polarisation: on(2),
            single_precision: on(3),
            universal_pdg: on(4).then_some(PHOTON),
            universal_weight: on(5).then_some(2.0),
            source: b"test".to_vec(),
            comments: vec![b"c".to_vec(), stat_sum_comment("n", 7.0).unwrap()],
            blobs: vec![(b"k".to_vec(), vec![0, 255])],
            ..McplHeader::default()
        };
        let particle = |i: u32| Particle {
            position_cm: [0.5, f64::from(i), -1.0],
            direction: [[0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [-0.8, 0.6, 0.0]][i as usize],
            energy_mev: 0.25,
            time_ms: 0.125,
            weight: 2.0,
            polarisation: if on(2) { [0.0, 0.5, 1.0] } else { [0.0; 3] },
            pdg: PHOTON,
            user_flags: if on(1) { 0xdead_beef } else { 0 },
        };
        let file = McplFile::new(header, (0..3).map(particle)).unwrap();
        let bytes = file.write();
        let again = McplFile::read(&bytes).unwrap();
        assert_eq!(again, file);
        assert_eq!(again.write(), bytes);
        for (found, expected) in again.particles().zip((0..3).map(particle)) {
            // f32 rounds each component and its inverse by 6e-8.
            let slack = if on(3) { 2e-7 } else { 1e-15 };
            for (a, b) in found.direction.iter().zip(expected.direction) {
                assert!((a - b).abs() < slack, "{found:?} {expected:?}");
            }
            let direction = expected.direction;
            assert_eq!(Particle { direction, ..found }, expected);
        }
        let packed = convert(&RayFile::Mcpl(file.clone()), Format::McplGz).unwrap();
        assert!(packed.notes.is_empty() && gz::is_packed(&packed.bytes));
        assert_eq!(RayFile::read(&packed.bytes).unwrap(), RayFile::Mcpl(file));
    }
}

#[test]
fn tm25_keeps_every_column() {
    let header = tm25::Tm25Header {
        spectrum_type: SpectrumType::None,
        flags: Flags {
            radiant_flux: true,
            wavelength: true,
            luminous_flux: true,
            stokes: true,
            tristimulus: true,
            spectrum: false,
        },
        extra_columns: vec!["time".to_owned()],
        additional_text: "more".to_owned(),
        text_room: 8,
        ..tm25::Tm25Header::default()
    };
    assert_eq!(header.columns(), 18);
    let mut ray: Vec<f32> = (0..18_u8).map(f32::from).collect();
    ray[3..6].copy_from_slice(&[0.0, 0.0, 1.0]);
    let file = Tm25File::new(header, ray).unwrap();
    let again = Tm25File::read(&file.write()).unwrap();
    assert_eq!(again.write(), file.write());
    let set = again.rays();
    assert_eq!((set.powers[0], set.unit), (6.0, PowerUnit::Watt));
    assert!((set.wavelength(0).unwrap() - 7e-9).abs() < 1e-22);
    let notes = convert(&RayFile::Tm25(Box::new(again)), Format::Npy)
        .unwrap()
        .notes;
    assert_eq!(notes.len(), 6, "{notes:?}");
}

#[test]
fn tm25_of_lumens_and_a_spectrum_per_ray() {
    let header = tm25::Tm25Header {
        spectrum_type: SpectrumType::SpectrumPerRay,
        luminous_flux: 8.0,
        radiant_flux: 2.0,
        flags: Flags {
            luminous_flux: true,
            spectrum: true,
            ..Flags::default()
        },
        spectra: vec![vec![[400.0, 1.0]], vec![[500.0, 0.5], [600.0, 1.0]]],
        ..tm25::Tm25Header::default()
    };
    let ray = |spectrum| vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 8.0, spectrum];
    let file = Tm25File::new(header.clone(), ray(2.0)).unwrap();
    assert_eq!(Tm25File::read(&file.write()).unwrap().write(), file.write());
    assert_eq!(file.rays().unit, PowerUnit::Lumen);
    assert_eq!(file.watts_per_lumen(), Some(0.25));
    for wrong in [0.0, 3.0, 1.5] {
        assert!(Tm25File::new(header.clone(), ray(wrong)).is_err());
    }
}

fn some_rays(wavelengths: Wavelengths, unit: PowerUnit) -> RaySet {
    RaySet {
        positions: vec![[0.0, 0.25, -1.0], [1e-3, 0.0, 2.0]],
        directions: vec![[0.0, 0.6, 0.8], [-1.0, 0.0, 0.0]],
        powers: vec![0.5, 0.25],
        unit,
        wavelengths,
    }
}

/// Converts rays from each format to each other format and back. The rays agree to the precision of
/// the formats.
#[test]
fn rays_are_the_same_in_all_formats() {
    for wavelengths in [
        Wavelengths::Unknown,
        Wavelengths::One(500e-9),
        Wavelengths::Each(vec![500e-9, 633e-9]),
    ] {
        let set = some_rays(wavelengths, PowerUnit::Watt);
        for format in [Format::Npy, Format::Mcpl, Format::McplGz, Format::Tm25] {
            let written = convert(&RayFile::Npy(set.clone()), format).unwrap();
            let found = RayFile::read(&written.bytes).unwrap().rays();
            // f32 rounds by 6e-8, f64 by 1e-16; lengths in other units are rounded once more.
            let slack = if format == Format::Tm25 { 1e-7 } else { 4e-16 };
            for ray in 0..set.len() {
                let numbers = |s: &RaySet| {
                    let wavelength = s.wavelength(ray).unwrap_or(0.0) * 1e6;
                    let [p, d] = [s.positions[ray], s.directions[ray]];
                    [
                        p[0],
                        p[1],
                        p[2],
                        d[0],
                        d[1],
                        d[2],
                        s.powers[ray],
                        wavelength,
                    ]
                };
                for (a, b) in numbers(&found).iter().zip(numbers(&set)) {
                    assert!(
                        (a - b).abs() <= slack * b.abs().max(1.0),
                        "{format} {a} {b}"
                    );
                }
            }
            let unit = if format == Format::Npy {
                PowerUnit::Weight
            } else {
                PowerUnit::Watt
            };
            assert_eq!(found.unit, unit);
        }
    }
}

#[test]
fn a_photon_of_1239_84_nm_has_an_electronvolt() {
    assert!((PHOTON_ENERGY_LENGTH / 1_239.841_984_332e-9 - 1e-6).abs() < 1e-18);
}

#[track_caller]
fn refused(bytes: &[u8], message: &str) {
    match RayFile::read(bytes) {
        Err(fault) => assert!(fault.to_string().contains(message), "{fault}"),
        Ok(_) => panic!("read; expected: {message}"),
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "a test may be a list of cases")]
fn malformed_files_are_refused_where_they_are() {
    let good = mcpl_2();
    refused(
        &good[..good.len() - 1],
        "byte 93: 1 particles of 28 bytes should follow, but 27 bytes do",
    );
    refused(&[&good[..], &[0; 28]].concat(), "but 56 bytes do");
    let stray = [&good[..], b"\n"].concat();
    assert_eq!(McplFile::read(&stray).unwrap().write(), stray);
    refused(&good[..60], "left");
    refused(b"hello", "not a supported ray file");
    refused(b"", "not a supported ray file");
    refused(b"MCPL004L", "MCPL002, MCPL003");
    let with = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    refused(&with(8, &u64::MAX.to_be_bytes()), "particles of 28 bytes");
    refused(&with(8, &0_u64.to_be_bytes()), "not closed");
    refused(
        &with(16, &u32::MAX.to_be_bytes()),
        "byte 16: the number of comments",
    );
    refused(
        &with(24, &2_u32.to_be_bytes()),
        "byte 24: the option of user flags is 2",
    );
    refused(
        &with(40, &29_u32.to_be_bytes()),
        "byte 40: a particle takes 29",
    );
    refused(&with(48, &f64::NAN.to_be_bytes()), "universal weight");
    let ray = good.len() - 28;
    refused(
        &with(ray, &f32::NAN.to_be_bytes()),
        "ray 0 (the first is 0): position",
    );
    refused(
        &with(ray + 12, &f32::NAN.to_be_bytes()),
        "ray 0 (the first is 0): packed direction",
    );
    refused(&with(ray + 20, &f32::INFINITY.to_be_bytes()), "energy");

    let good = tm25_by_hand();
    let with = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    let ray = good.len() - 28;
    refused(
        &good[..good.len() - 4],
        "1 rays of 28 bytes should follow, but 24 bytes do",
    );
    refused(&with(4, &2014_i32.to_le_bytes()), "version 2014");
    refused(&with(20, &u64::MAX.to_le_bytes()), "rays of 28 bytes");
    refused(&with(76, &u32::MAX.to_le_bytes()), "spectra");
    refused(
        &with(80, &u32::MAX.to_le_bytes()),
        "the name of a column takes 512 bytes",
    );
    refused(&with(84, &33_u32.to_le_bytes()), "multiples of 32");
    refused(
        &with(84, &0xffff_ffe0_u32.to_le_bytes()),
        "additional text takes",
    );
    refused(
        &with(264, &0_u32.to_le_bytes()),
        "neither radiant nor luminous",
    );
    refused(
        &with(ray + 12, &[0; 12]),
        "ray 0 (the first is 0): its direction has the length 0",
    );
    refused(
        &with(ray + 16, &f32::INFINITY.to_le_bytes()),
        "ray 0 (the first is 0): ky is inf",
    );
    refused(
        &with(ray + 24, &(-1.0_f32).to_le_bytes()),
        "radiant flux is -1",
    );
}

#[test]
fn a_file_that_unpacks_to_much_more_is_refused() {
    let mut bytes = mcpl_2();
    bytes.resize(64 << 20, 0);
    refused(&gz::pack(&bytes), "unpacks to more than");
}

#[test]
fn negative_weights_go_into_no_tm25() -> Result<(), Fault> {
    let mut set = some_rays(Wavelengths::Unknown, PowerUnit::Watt);
    set.powers[1] = -0.25;
    let fault = convert(&RayFile::Npy(set.clone()), Format::Tm25).unwrap_err();
    assert!(fault.to_string().contains("ray 1"), "{fault}");
    convert(&RayFile::Npy(set), Format::Mcpl).map(|_| ())
}

/// A photon with so little energy that its wavelength exceeds the largest number.
#[test]
fn what_is_written_can_be_read() {
    let set = some_rays(
        Wavelengths::Each(vec![500e-9, f64::INFINITY]),
        PowerUnit::Watt,
    );
    let negative = RaySet {
        powers: vec![-0.25, 0.5],
        ..some_rays(Wavelengths::Unknown, PowerUnit::Watt)
    };
    for (set, ray) in [(set, "ray 1"), (negative, "ray 0")] {
        for format in [Format::Npy, Format::Mcpl, Format::Tm25] {
            match convert(&RayFile::Npy(set.clone()), format) {
                Ok(written) => assert!(RayFile::read(&written.bytes).is_ok(), "{format}"),
                Err(fault) => assert!(fault.to_string().contains(ray), "{format}: {fault}"),
            }
        }
        assert!(convert(&RayFile::Npy(set), Format::Npy).is_err());
    }
}
